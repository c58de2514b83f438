
    subroutine ${name}_evaluate_jacobian(state, bearing, pin, jacobian)
        type(${name}_state), intent(in) :: state
        real(wp), intent(in) :: bearing(6), pin(6)
        type(${name}_jacobian), intent(inout) :: jacobian

        call evaluate_jacobian(state, bearing, pin, jacobian, this_joint, this_law)
    end subroutine ${name}_evaluate_jacobian

    ! The derivative of every number of the wrench along a direction of both bodies; flag 0.
    subroutine ${name}_differentiate(state, bearing, pin, bearing_along, pin_along, derivative)
        type(${name}_state), intent(in) :: state
        real(wp), intent(in) :: bearing(6), pin(6), bearing_along(6), pin_along(6)
        type(${name}_wrench), intent(inout) :: derivative

        call differentiate(state, bearing, pin, bearing_along, pin_along, derivative, &
            this_joint, this_law)
    end subroutine ${name}_differentiate

    ! The energy that the contact stores.
    function ${name}_elastic_energy(bearing, pin) result(answer)
        real(wp), intent(in) :: bearing(6), pin(6)
        real(wp) :: answer

        answer = elastic_energy(bearing, pin, this_joint, this_law)
    end function ${name}_elastic_energy
