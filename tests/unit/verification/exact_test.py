#!/usr/bin/env python3
"""exact_test.py ROOT: the exact solutions of validation/verify against tables, limits and their own equations."""

import math
import sys
import unittest
from pathlib import Path

import numpy as np
from scipy import special

ROOT = Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "validation" / "verify"))

import exact  # noqa: E402
from scene import Scene, SceneMismatch, formula_value  # noqa: E402

from record import quantity  # noqa: E402


def scene(box, nu, **tables) -> Scene:
    return Scene({"domain": {"channel": {"from": [f"{x} m" for x in box[0]], "to": [f"{x} m" for x in box[1]]}},
                  "fluid": {"density": "2 kg/m3"}, "viscosity": {"dynamic": f"{2.0 * nu} Pa s"}, **tables})


def pushed(g: float, frequency: float = 0.0, dimension: int = 2) -> dict:
    force = {"acceleration": [f"{g} m/s2"] + (dimension - 1) * ["0 m/s2"]}
    if frequency:
        force["waveform"] = {"formula": f"cos(2*pi*{frequency}*t)"}
    return {"gravity": force}


SQUARE, CUBE = ((0, 0), (1, 1)), ((0, 0, 0), (1, 1, 1))
PIPE = {"centre": [0.0, 0.0], "radius": 0.5}


def derivative(function, places, t, axis=None, step=1e-4):
    """Central difference of function(places, t) along an axis of space, or in time (axis None)."""
    if axis is None:
        return (function(places, t + step) - function(places, t - step)) / (2.0 * step)
    e = step * np.eye(3)[axis]
    return (function(places + e, t) - function(places - e, t)) / (2.0 * step)


def laplacian(function, places, t, step=2e-3):
    """Fourth order, so that its own error stays below 1e-7 for waves of length 1."""
    total = 0.0
    for axis in range(3):
        e = step * np.eye(3)[axis]
        total = total + (-function(places + 2 * e, t) + 16 * function(places + e, t) - 30 * function(places, t)
                         + 16 * function(places - e, t) - function(places - 2 * e, t)) / (12.0 * step**2)
    return total


def momentum_residual(flow, places, t, nu, density=2.0):
    """du/dt + (u.grad)u + grad p / rho - nu lap u at the places, (n, 3); without p, its part along no gradient."""
    u = flow.velocity(places, t)
    residual = derivative(flow.velocity, places, t) - nu * laplacian(flow.velocity, places, t)
    for axis in range(3):
        residual = residual + u[:, [axis]] * derivative(flow.velocity, places, t, axis)
        if hasattr(flow, "pressure"):
            residual[:, axis] += derivative(flow.pressure, places, t, axis) / density
    return residual


def thinning(power: float, relaxation_time: float = 1.0, high: float = 0.001) -> dict:
    law = {"high_shear": f"{high} Pa s", "relaxation_time": f"{relaxation_time} s", "power": power, "transition": 2.0}
    return {"viscosity": {"dynamic": "0.2 Pa s", "carreau_yasuda": law}}


PLACES = np.random.default_rng(7).random((40, 3))


class CarreauYasuda(unittest.TestCase):
    def test_a_power_of_one_is_the_newtonian_parabola(self):
        flow = exact.CarreauYasudaChannel(scene(SQUARE, 0.1, **(pushed(0.8) | thinning(1.0))))
        y = PLACES[:, 1]
        self.assertLess(np.max(np.abs(flow.velocity(PLACES, 0.0)[:, 0] - 4.0 * y * (1.0 - y))), 1e-6)

    def test_a_long_relaxation_time_is_the_power_law_fluid(self):
        # mu = K G^(n-1), K = mu0 t^(n-1): u(H/2) = n/(n+1) (rho g / K)^(1/n) (H/2)^((n+1)/n) (Bird, Stewart, Lightfoot).
        n, time = 0.5, 1e4
        flow = exact.CarreauYasudaChannel(scene(SQUARE, 0.1, **(pushed(0.8) | thinning(n, time, high=1e-12))))
        peak = n / (n + 1.0) * (1.6 / (0.2 * time ** (n - 1.0))) ** (1.0 / n) * 0.5 ** ((n + 1.0) / n)
        found = flow.velocity(np.array([[0.0, 0.5, 0.0]]), 0.0)[0, 0]
        self.assertAlmostEqual(found / peak, 1.0, delta=1e-4)

    def test_the_force_is_the_divergence_of_the_stress(self):
        flow = exact.CarreauYasudaChannel(scene(SQUARE, 0.1, **(pushed(0.8) | thinning(0.4))))
        y = np.linspace(0.05, 0.45, 9)

        def stress(at):
            rate = derivative(flow.velocity, np.column_stack([at, at, 0.0 * at]), 0.0, axis=1, step=2e-3)[:, 0]
            return np.array([flow.viscosity(g) for g in rate]) * rate

        push = -(stress(y + 0.01) - stress(y - 0.01)) / 0.02
        self.assertLess(np.max(np.abs(push / 1.6 - 1.0)), 2e-3)  # steps of 0.01 and 0.002 m


class Channels(unittest.TestCase):
    def test_start_up_poiseuille_against_tabulated_centre_velocities(self):
        # u_c / u_max at nu t / a^2, from the series of the half channel (method, section 5).
        flow = exact.ForcedChannel(scene(SQUARE, 0.1, **pushed(0.8)))
        for number, wanted in ((0.1, 0.197746), (0.5, 0.699455), (1.0, 0.912477)):
            found = flow.velocity(np.array([[0.3, 0.5, 0.0]]), number * 0.25 / 0.1)[0]
            self.assertAlmostEqual(found[0], wanted, delta=1e-6)
            self.assertEqual(tuple(found[1:]), (0.0, 0.0))

    def test_start_up_poiseuille_ends_at_the_parabola(self):
        flow = exact.ForcedChannel(scene(SQUARE, 0.1, **pushed(0.8)))
        y = PLACES[:, 1]
        np.testing.assert_allclose(flow.velocity(PLACES, 60.0)[:, 0], 4.0 * y * (1.0 - y), atol=1e-6)

    def test_pressures_at_both_ends_act_as_their_force(self):
        ends = {"inflow": {"side": "left", "pressure": "1 Pa"}, "outflow": {"side": "right", "pressure": "4.2 Pa"}}
        flow = exact.ForcedChannel(scene(((0, 0), (2, 1)), 0.1, **ends))
        self.assertAlmostEqual(flow.force, -3.2 / (2.0 * 2.0))  # (p_left - p_right) / (rho L)

    def test_womersley_amplitude_in_a_channel_against_the_table(self):
        # |u_c| over the quasi-steady g a^2 / (2 nu) (method, section 5).
        for alpha, wanted in ((1, 0.92631), (2, 0.52084), (4, 0.13910), (10, 0.01998)):
            nu = 0.25 * 2.0 * math.pi / alpha**2
            flow = exact.ForcedChannel(scene(SQUARE, nu, **pushed(1.0, 1.0)), frequency=1.0)
            self.assertAlmostEqual(flow.womersley_number, alpha)
            centre = np.array([[0.0, 0.5, 0.0]])
            late = [flow.velocity(centre, 200.0 + phase)[0, 0] for phase in (0.0, 0.25)]
            self.assertAlmostEqual(math.hypot(*late) / (0.25 / (2.0 * nu)), wanted, delta=6e-6)

    def test_womersley_in_a_channel_against_its_closed_form(self):
        # u = Re[(g / i omega)(1 - cosh(k s)/cosh(k a)) e^{i omega t}], k^2 = i omega / nu, once the start is forgotten.
        nu, omega = 0.1, 2.0 * math.pi
        flow = exact.ForcedChannel(scene(SQUARE, nu, **pushed(1.0, 1.0)), frequency=1.0)
        k = np.sqrt(1j * omega / nu)
        shape = 1.0 - np.cosh(k * (PLACES[:, 1] - 0.5)) / np.cosh(0.5 * k)
        wanted = np.real(shape / (1j * omega) * np.exp(1j * omega * 40.3))
        np.testing.assert_allclose(flow.velocity(PLACES, 40.3)[:, 0], wanted, atol=1e-8)

    def test_forced_channel_obeys_its_equation_while_it_starts(self):
        flow = exact.ForcedChannel(scene(SQUARE, 0.1, **pushed(1.0, 1.0)), frequency=1.0)
        for t in (0.1, 0.4):
            inner = PLACES[(PLACES[:, 1] > 0.1) & (PLACES[:, 1] < 0.9)]
            left = momentum_residual(flow, inner, t, 0.1)[:, 0] - math.cos(2.0 * math.pi * t)
            self.assertLess(np.max(np.abs(left)), 1e-4)  # time differences of 1e-4: 1e-8 x third derivative

    def test_couette(self):
        flow = exact.StartUpCouette(scene(SQUARE, 0.1, wall_motion={"top": {"velocity": ["3 m/s", "0 m/s"]}}))
        np.testing.assert_allclose(flow.velocity(PLACES, 80.0)[:, 0], 3.0 * PLACES[:, 1], atol=1e-9)
        early = 0.01  # the wall above knows nothing of the one below: u = U erfc((1 - y) / (2 sqrt(nu t)))
        wanted = 3.0 * special.erfc((1.0 - PLACES[:, 1]) / (2.0 * math.sqrt(0.1 * early)))
        np.testing.assert_allclose(flow.velocity(PLACES, early)[:, 0], wanted, atol=1e-8)

    def test_a_waveform_that_the_solution_is_not_for_is_refused(self):
        with self.assertRaises(SceneMismatch):
            exact.ForcedChannel(scene(SQUARE, 0.1, **pushed(1.0, 1.0)))


class Pipes(unittest.TestCase):
    def test_womersley_amplitude_in_a_pipe_against_the_table(self):
        # |u_c| over the quasi-steady g R^2 / (4 nu) (method, section 5).
        for alpha, wanted in ((1, 0.98493), (2, 0.81650), (4, 0.30802), (10, 0.03975)):
            nu = 0.25 * 2.0 * math.pi / alpha**2
            flow = exact.ForcedPipe(scene(CUBE, nu, **pushed(1.0, 1.0, 3)), **PIPE, frequency=1.0)
            late = [flow.velocity(np.zeros((1, 3)), 200.0 + phase)[0, 0] for phase in (0.0, 0.25)]
            self.assertAlmostEqual(math.hypot(*late) / (0.25 / (4.0 * nu)), wanted, delta=3e-5)  # slow series on the axis

    def test_womersley_in_a_pipe_against_its_closed_form(self):
        nu, omega = 0.1, 2.0 * math.pi
        flow = exact.ForcedPipe(scene(CUBE, nu, **pushed(1.0, 1.0, 3)), **PIPE, frequency=1.0)
        k = np.sqrt(-1j * omega / nu)
        places = PLACES - 0.5
        r = np.hypot(places[:, 1], places[:, 2])
        inside = r < 0.5
        shape = 1.0 - special.jv(0, k * r) / special.jv(0, 0.5 * k)
        wanted = np.where(inside, np.real(shape / (1j * omega) * np.exp(1j * omega * 40.3)), 0.0)
        np.testing.assert_allclose(flow.velocity(places, 40.3)[:, 0], wanted, atol=2e-6)
        mean = (1.0 - 2.0 * special.jv(1, 0.5 * k) / (0.5 * k * special.jv(0, 0.5 * k))) / (1j * omega)
        self.assertAlmostEqual(flow.mean_velocity(40.3), np.real(mean * np.exp(1j * omega * 40.3)), delta=1e-8)

    def test_pipe_ends_at_hagen_and_poiseuille(self):
        flow = exact.ForcedPipe(scene(CUBE, 0.1, **pushed(1.6, dimension=3)), **PIPE)
        places = np.array([[0.0, 0.3, 0.0], [0.0, 0.0, 0.4], [0.0, 0.2, 0.2]])
        r2 = np.sum(places[:, 1:] ** 2, axis=1)
        np.testing.assert_allclose(flow.velocity(places, 60.0)[:, 0], 4.0 * (0.25 - r2), atol=3e-6)
        self.assertAlmostEqual(flow.mean_velocity(60.0), 0.5, delta=1e-6)  # Q = pi R^4 dp / (8 mu L)


class Vortices(unittest.TestCase):
    def test_taylor_green_solves_the_equations(self):
        flow = exact.TaylorGreen(scene(SQUARE, 0.01))
        places = PLACES * [1, 1, 0]
        residual = momentum_residual(flow, places, 0.3, 0.01)
        self.assertLess(np.max(np.abs(residual)), 1e-5)
        self.assertAlmostEqual(np.max(np.abs(flow.velocity(np.array([[0.25, 0.0, 0.0]]), 1.0))),
                               math.exp(-8.0 * math.pi**2 * 0.01))  # L = U = 1

    def test_energies_are_integrals_of_the_velocities(self):
        middle = (np.arange(16) + 0.5) / 16
        plane = np.stack(np.meshgrid(middle, middle, [0.0]), -1).reshape(-1, 3)
        cube = np.stack(np.meshgrid(middle, middle, middle), -1).reshape(-1, 3)
        for flow, places in ((exact.TaylorGreen(scene(SQUARE, 0.01)), plane),
                             (exact.TriPeriodicVortices(scene(CUBE, 0.01)), cube),
                             (exact.TaylorGreenSeries(scene(CUBE, 0.01)), cube)):
            t = 0.1
            integral = 0.5 * 2.0 * np.mean(np.sum(flow.velocity(places, t) ** 2, axis=1))
            self.assertAlmostEqual(float(np.squeeze(flow.kinetic_energy(t))), integral, delta=1e-6 * integral)

    def test_tri_periodic_vortices_are_beltrami_and_solenoidal(self):
        # curl u = sqrt(3) k u makes (u.grad)u a gradient; the shape is kept and decays with 3 nu k^2.
        flow, t = exact.TriPeriodicVortices(scene(CUBE, 0.01)), 0.2
        rows = [derivative(flow.velocity, PLACES, t, axis, 1e-5) for axis in range(3)]
        divergence = rows[0][:, 0] + rows[1][:, 1] + rows[2][:, 2]
        curl = np.column_stack([rows[1][:, 2] - rows[2][:, 1], rows[2][:, 0] - rows[0][:, 2],
                                rows[0][:, 1] - rows[1][:, 0]])
        self.assertLess(np.max(np.abs(divergence)), 1e-7)
        np.testing.assert_allclose(curl, math.sqrt(3.0) * 2.0 * math.pi * flow.velocity(PLACES, t), atol=1e-6)
        decay = derivative(flow.velocity, PLACES, t) - 0.01 * laplacian(flow.velocity, PLACES, t)
        self.assertLess(np.max(np.abs(decay)), 1e-5)

    def test_taylor_green_series_has_the_dissipation_of_1937(self):
        # Taylor & Green, Proc. R. Soc. A 158 (1937): W/W0 = 1 - 6 T/R + (5/48 + 18/R^2) T^2 - (5/3 + 36/R^2) T^3/R + ...
        grid = exact.TaylorGreenSeries.GRID
        wave = np.stack(np.meshgrid(*3 * [np.fft.fftfreq(grid, 1.0 / grid)], indexing="ij"))
        square = np.sum(wave**2, axis=0)
        for number in (1.0, 20.0):
            terms = exact.taylor_green_terms(1.0 / number, 4, grid)
            found = [sum(np.sum(square * np.real(terms[m] * np.conj(terms[n - m]))) for m in range(n + 1))
                     for n in range(4)]
            wanted = [1.0, -6.0 / number, 5 / 48 + 18.0 / number**2, -(5 / 3 + 36.0 / number**2) / number]
            np.testing.assert_allclose(np.array(found) / found[0], wanted, rtol=1e-10)

    def test_taylor_green_series_is_cut_off_where_it_does_not_matter(self):
        self.assertLess(exact.TaylorGreenSeries(scene(CUBE, 0.01)).last_term(0.12), 1e-3)


class Scenes(unittest.TestCase):
    def test_quantities(self):
        for text, wanted in (("3.75 mm", 3.75e-3), ("1000 kg/m3", 1e3), ("9.81 m/s2", 9.81), ("0.7 MPa", 7e5),
                             ("1 mPa s", 1e-3), ("5", 5.0), ("2 mm2/s", 2e-6), ("-3 cm", -0.03)):
            self.assertAlmostEqual(quantity(text), wanted, delta=1e-12 * abs(wanted))
        for text in ("mm", "3 parsec", "1 2 m"):
            with self.assertRaises(ValueError, msg=text):
                quantity(text)

    def test_formulas(self):
        self.assertAlmostEqual(formula_value("-cos(2*pi*x)*sin(2*pi*y)/2^2", x=0.5, y=0.25), 0.25)
        self.assertAlmostEqual(formula_value("min(t/0.1, 1)", t=0.05), 0.5)
        for text in ("__import__('os')", "open", "x.y", "t"):
            with self.assertRaises(SceneMismatch, msg=text):
                formula_value(text)

    def test_initial_velocities_of_the_cases_are_the_exact_ones(self):
        for file, flow in (("taylor_green/scene.toml", exact.TaylorGreen),
                           ("taylor_green_3d/scene.toml", exact.TriPeriodicVortices),
                           ("taylor_green_3d/scene_classical.toml", exact.TaylorGreenSeries)):
            start = Scene.of_toml((ROOT / "validation" / file).read_text())
            formulas = start.entry("initial.velocity")
            wanted = flow(start).velocity(PLACES * np.array([1, 1, start.dimension - 2]), 0.0)
            found = [[formula_value(f, x=p[0], y=p[1], z=p[2]) for f in formulas] for p in PLACES]
            np.testing.assert_allclose(found, wanted[:, : len(formulas)], atol=1e-12, err_msg=file)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
