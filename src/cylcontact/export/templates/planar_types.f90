
    public :: ${name}_jacobian
    public :: ${name}_evaluate_jacobian
    public :: ${name}_differentiate
    public :: ${name}_elastic_energy

    ! Derivatives of force x, force y and moment of bearing and pin, row by row, by x, y and
    ! angle of bearing and pin, and by their rates, at a fixed impact rate.
    type :: ${name}_jacobian
        real(wp) :: by_position(36)
        real(wp) :: by_velocity(36)
    end type ${name}_jacobian
