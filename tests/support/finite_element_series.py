"""A pin in a ring by Michell's series: the same problem as the finite elements, without a mesh.

The ring is held along its whole outer boundary, the pin carries its load as a body force. Each
harmonic of the pressure is a small linear system for the coefficients of Airy's functions (Barber,
Elasticity, the tables of Michell's solution); strips of constant pressure then meet the contact
condition at their middles. Nothing here comes from the package.
"""

import numpy as np
from scipy.optimize import brentq

HARMONICS = 6000
STRIPS = 60


class PinInRing:
    """Radii in mm, plate and pin as (E in MPa, ν), one material by default; plane strain."""

    def __init__(self, hole_radius, dR, outer_radius, plate, pin=None):
        self.a, self.dR, self.c = hole_radius, dR, outer_radius
        self.b = hole_radius - dR
        (E, nu), (pin_E, pin_nu) = plate, pin or plate
        self.mu, self.kappa = E / (2 * (1 + nu)), 3 - 4 * nu
        self.pin_mu, self.pin_kappa = pin_E / (2 * (1 + pin_nu)), 3 - 4 * pin_nu
        self.pin_lame = pin_E * pin_nu / ((1 + pin_nu) * (1 - 2 * pin_nu))
        self.opening = np.array([self._ring(n) + self._disc(n) for n in range(HARMONICS)])

    def penetration(self, load):
        """Return δ in mm, the contact's semi-angle and the peak pressure in MPa."""
        angle = brentq(lambda e: self._strips(e, load)[0][-1], 0.05, 1.0, xtol=1e-5)
        pressure, depth = self._strips(angle, load)
        return depth, angle, pressure[0]

    def _strips(self, angle, load):
        """Solve for the strips' pressures and δ if the contact reaches to `angle`."""
        edges = np.linspace(0, angle, STRIPS + 1)
        middle = (edges[:-1] + edges[1:]) / 2
        n = np.arange(1, HARMONICS)[:, None]
        part = np.empty((HARMONICS, STRIPS))  # the harmonics of a unit pressure on each strip
        part[0] = np.diff(edges) / np.pi
        part[1:] = 2 / np.pi * np.diff(np.sin(n * edges), axis=1) / n
        wave = np.cos(np.arange(HARMONICS) * middle[:, None])
        matrix = np.zeros((STRIPS + 1, STRIPS + 1))
        matrix[:-1, :-1] = wave @ (self.opening[:, None] * part)
        matrix[:-1, -1] = -np.cos(middle)
        matrix[-1, :-1] = np.pi * self.a * part[1]
        ray = self.dR * np.cos(middle) + np.sqrt(self.b**2 - (self.dR * np.sin(middle)) ** 2)
        right = np.append(-(self.a - ray) - self._lift(middle) * load, load)
        actual = np.linalg.solve(matrix, right)
        return actual[:-1], actual[-1]

    def _ring(self, n):
        """Return the radial displacement at the hole under a pressure cos nθ of 1 MPa."""
        k, a, c = self.kappa, self.a, self.c
        if n == 0:
            rows = [[2, 1 / a**2], [(k - 1) * c, -1 / c]]
            r2, log = np.linalg.solve(rows, [-1, 0])
            return ((k - 1) * a * r2 - log / a) / (2 * self.mu)
        if n == 1:
            # rθ sin θ with as much of r ln r cos θ as makes the displacement single-valued.
            m = -(k - 1) / (k + 1)

            def force(r):
                radial = (-1 + (k + 1) * np.log(r)) / 2 + m * (-1 + (k - 1) * np.log(r)) / 2
                around = (-1 - (k + 1) * np.log(r)) / 2 + m * (-1 - (k - 1) * np.log(r)) / 2
                return radial, around

            rows = [
                [(2 + m) / a, 2 * a, -2 / a**3, 0],
                [m / a, 2 * a, -2 / a**3, 0],
                [force(c)[0], (k - 2) * c**2, 1 / c**2, 1],
                [force(c)[1], (k + 2) * c**2, 1 / c**2, -1],
            ]
            actual = np.linalg.solve(rows, [-1, 0, 0, 0])
            return actual @ [force(a)[0], (k - 2) * a**2, 1 / a**2, 1] / (2 * self.mu)
        q = (a / c) ** n  # the functions that grow are scaled to 1 at c, the others at a
        rows = [
            [
                -(n + 1) * (n - 2) * q,
                -(n + 2) * (n - 1),
                -n * (n - 1) * q / a**2,
                -n * (n + 1) / a**2,
            ],
            [n * (n + 1) * q, -n * (n - 1), n * (n - 1) * q / a**2, -n * (n + 1) / a**2],
            [(k - n - 1) * c, (k + n - 1) * c * q, -n / c, n / c * q],
            [(k + n + 1) * c, -(k - n + 1) * c * q, n / c, n / c * q],
        ]
        actual = np.linalg.solve(rows, [-1, 0, 0, 0])
        shape = [(k - n - 1) * a * q, (k + n - 1) * a, -n / a * q, n / a]
        return actual @ shape / (2 * self.mu)

    def _disc(self, n):
        """Return by how much a pressure cos nθ of 1 MPa moves the pin's surface inwards."""
        k, b = self.pin_kappa, self.b
        if n == 0:
            return (k - 1) * b / 2 / (2 * self.pin_mu)
        if n == 1:
            return 0.0  # with the body force, in _lift
        rows = [[-(n + 1) * (n - 2), -n * (n - 1) / b**2], [n * (n + 1), n * (n - 1) / b**2]]
        actual = np.linalg.solve(rows, [-1, 0])
        return -actual @ [(k - n - 1) * b, -n / b] / (2 * self.pin_mu)

    def _lift(self, theta):
        """Return the opening per N/mm by the body force and the pressure's first harmonic.

        The displacement −by²/(2(λ + 2μ)) along y balances a body force b; its tractions, and the
        pressure that carries the load, are taken off by Airy's functions of the disc.
        """
        k, radius, stiff = self.pin_kappa, self.b, self.pin_lame + 2 * self.pin_mu
        body, first = 1 / (np.pi * radius**2), 1 / (np.pi * radius)
        along, across = (
            -body * radius,
            -self.pin_lame / stiff * body * radius,
        )  # σ_yy, σ_xx over cos θ
        radial = {1: (3 * along + across) / 4, 3: (along - across) / 4}
        shear = {1: (across - along) / 4, 3: (across - along) / 4}
        moved = -body * radius**2 / (8 * stiff) * (3 * np.cos(theta) + np.cos(3 * theta))
        r3 = np.array([2 * radius, 2 * radius])
        wanted = np.array([-first - radial[1], -shear[1]])
        assert np.isclose(*wanted)  # one function meets both: the forces balance
        moved += wanted[0] / r3[0] * (k - 2) * radius**2 / (2 * self.pin_mu) * np.cos(theta)
        rows = [[-4 * radius**3, -6 * radius], [12 * radius**3, 6 * radius]]  # r⁵ and r³, n = 3
        actual = np.linalg.solve(rows, [-radial[3], -shear[3]])
        third = actual @ [(k - 4) * radius**4, -3 * radius**2] / (2 * self.pin_mu)
        return -(moved + third * np.cos(3 * theta))
