"""The motion of crank, rod and slider, and the forces that the ideal joints carry.

Points of the plane are complex numbers, x + iy. With the force f on the slider and moments on rod
and slider from the joint with clearance, `slider_crank` has the equations; here they give the
accelerations, and Newton's and Euler's equations of each body the reactions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from cylcontact.mechanism.slider_crank import SliderCrank
from cylcontact.support.arrays import FloatArray, as_floats

Complex = Any


def cross(a: Complex, b: Complex) -> Any:
    """Return a_x·b_y − a_y·b_x."""
    return (np.conj(a) * b).imag


@dataclass(frozen=True, eq=False)
class Motion:
    """Positions, velocities and accelerations of a slider-crank, and the reactions of its joints.

    Every array is in SI and of the shape of the crank's angle. Reactions are in the frame with its
    first axis along the slide: `pivot_force` on the crank, `crank_pin_force` on the rod, and
    `guide_force` across the slide and `guide_moment` on the slider.

    Parameters
    ----------
    mechanism : SliderCrank
    crank_angle : array of float
        In rad.
    E, E_rate : complex or array of complex
        The coordinates of `slider_crank` and their rates.
    load : array of complex
        The force of the joint with clearance on the slider in N.
    rod_moment, slider_moment : float or array of float
        The moments of that force on the rod about its end, and on the slider about its joint, N m.
    """

    mechanism: SliderCrank
    crank_angle: FloatArray
    E: Complex = 0.0
    E_rate: Complex = 0.0
    load: Complex = None
    rod_moment: Any = 0.0
    slider_moment: Any = 0.0

    @cached_property
    def _m(self) -> Any:
        return self.mechanism.record

    @cached_property
    def _gravity(self) -> complex:
        return complex(*self.mechanism.spec.gravity)

    @cached_property
    def crank_pin(self) -> Complex:
        """The crank pin A as complex numbers in m."""
        return self._m["crank"] * np.exp(1j * self.crank_angle)

    @cached_property
    def rod_angle(self) -> FloatArray:
        """The rod's angle from the slide in rad."""
        height = self._m["offset"] - self.crank_pin.imag - np.imag(self.E)
        return as_floats(np.arcsin(height / self._m["rod"]))

    @cached_property
    def _rod(self) -> Complex:
        """The unit vector along the rod."""
        return np.exp(1j * self.rod_angle)

    @cached_property
    def rod_spin(self) -> FloatArray:
        """The rod's angular velocity in rad/s."""
        rise = self._m["omega"] * self.crank_pin.real + np.imag(self.E_rate)
        return as_floats(-rise / (self._m["rod"] * self._rod.real))

    @cached_property
    def slider_position(self) -> FloatArray:
        """The slider's position along the slide in m."""
        return as_floats((self.crank_pin + self._m["rod"] * self._rod + self.E).real)

    @cached_property
    def slider_velocity(self) -> FloatArray:
        """The slider's velocity in m/s."""
        turning = 1j * self._m["omega"] * self.crank_pin
        turning = turning + 1j * self.rod_spin * self._m["rod"] * self._rod
        return as_floats((turning + self.E_rate).real)

    # --- accelerations and reactions ---

    @cached_property
    def _crank_pin_acceleration(self) -> Complex:
        return -(self._m["omega"] ** 2) * self.crank_pin

    @cached_property
    def _ideal_acceleration(self) -> tuple[FloatArray, FloatArray]:
        """The rod's angular acceleration and the slider's acceleration without clearance."""
        m, square = self._m, self.rod_spin**2
        # Im and Re of Ä + L·(iφ̈ − φ̇²)·u.
        across = self._crank_pin_acceleration.imag - m["rod"] * square * self._rod.imag
        spin_rate = -across / (m["rod"] * self._rod.real)
        along = self._crank_pin_acceleration + m["rod"] * (1j * spin_rate - square) * self._rod
        return spin_rate, along.real

    @cached_property
    def _force(self) -> Complex:
        """The force on the slider; without a clearance what its joint must carry."""
        if self.load is not None:
            return self.load
        m, (spin_rate, along) = self._m, self._ideal_acceleration
        f_x = self.mechanism.spec.slider.mass * (along - self._gravity.real)
        inertial = m["rod_mass"] * m["rod_a"] * self._lean + spin_rate / m["per_rod_inertia"]
        f_y = (m["rod"] * self._rod.imag * f_x - inertial) / (m["rod"] * self._rod.real)
        return f_x + 1j * f_y

    @cached_property
    def _lean(self) -> FloatArray:
        """The acceleration of the rod's crank end less gravity, across the rod."""
        return as_floats(cross(self._rod, self._crank_pin_acceleration - self._gravity))

    @cached_property
    def _rod_spin_rate(self) -> FloatArray:
        """The rod's angular acceleration in rad/s²."""
        m = self._m
        turning = -m["rod"] * cross(self._rod, self._force) + self.rod_moment
        return as_floats((turning - m["rod_mass"] * m["rod_a"] * self._lean) * m["per_rod_inertia"])

    @cached_property
    def slider_acceleration(self) -> FloatArray:
        """The slider's acceleration in m/s²."""
        return as_floats(self._force.real * self._m["per_slider_mass"] + self._gravity.real)

    @cached_property
    def crank_pin_force(self) -> Complex:
        """The force of the crank on the rod in N, complex."""
        m, turning = self._m, 1j * self._rod_spin_rate - self.rod_spin**2
        centre = self._crank_pin_acceleration + m["rod_a"] * turning * self._rod
        return m["rod_mass"] * (centre - self._gravity) + self._force

    @cached_property
    def pivot_force(self) -> Complex:
        """The force of the ground on the crank in N, complex."""
        share = self.mechanism.spec.crank.centre
        centre = share * self._crank_pin_acceleration
        return self._m["crank_mass"] * (centre - self._gravity) + self.crank_pin_force

    @cached_property
    def crank_moment(self) -> FloatArray:
        """The moment of the driver on the crank in N m."""
        arm = self.mechanism.spec.crank.centre * self.crank_pin
        weight = cross(arm, self._m["crank_mass"] * self._gravity)
        return as_floats(cross(self.crank_pin, self.crank_pin_force) - weight)

    @cached_property
    def guide_force(self) -> FloatArray:
        """The force of the guide on the slider, across the slide, in N."""
        return as_floats(-self._force.imag - self.mechanism.spec.slider.mass * self._gravity.imag)

    @property
    def guide_moment(self) -> FloatArray:
        """The moment of the guide on the slider in N m."""
        return as_floats(-self.slider_moment + 0.0 * self.crank_angle)

    # --- energies ---

    @cached_property
    def kinetic_energy(self) -> FloatArray:
        """The kinetic energy of all bodies in J."""
        m, spec = self._m, self.mechanism.spec
        A_rate = 1j * m["omega"] * self.crank_pin
        centre = A_rate + 1j * self.rod_spin * m["rod_a"] * self._rod
        energy = spec.slider.mass * self.slider_velocity**2
        energy = energy + spec.rod.mass * np.abs(centre) ** 2 + spec.rod.inertia * self.rod_spin**2
        crank = spec.crank.mass * np.abs(spec.crank.centre * A_rate) ** 2
        return as_floats(0.5 * (energy + crank + spec.crank.inertia * m["omega"] ** 2))

    @cached_property
    def potential_energy(self) -> FloatArray:
        """The potential energy of gravity in J."""
        spec, rod_centre = self.mechanism.spec, self.crank_pin + self._m["rod_a"] * self._rod
        moment = spec.crank.mass * spec.crank.centre * self.crank_pin + spec.rod.mass * rod_centre
        moment = moment + spec.slider.mass * self.slider_position
        return as_floats(-(moment * np.conj(self._gravity)).real)
