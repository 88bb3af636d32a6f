"""Exact solutions of the incompressible Navier-Stokes equations that the particle solver is judged by.

Each class is one flow: made from a resolved scene (so that no number stands twice) and the parameters of a
verification.toml, it gives velocity(places, t) in m/s for places (n, 3) in m. Some give more: pressure,
kinetic_energy, mean_velocity. tests/verification/exact_solutions_test.py holds them to tabulated values, to
their steady limits and to the differential equation itself.
"""

import functools
import math

import numpy as np
from scipy import integrate, optimize, special

from scene import Scene, SceneMismatch

TERMS = 1000  # of each series: they fall at least like n^-2.5, so what is cut off is below 1e-6 of the sum


def response(rate: np.ndarray, frequency: float, t: float) -> np.ndarray:
    """T(t) of T' + rate T = cos(2 pi frequency t), T(0) = 0, by variation of constants. In s."""
    omega = 2.0 * math.pi * frequency
    numerator = rate * np.cos(omega * t) + omega * np.sin(omega * t) - rate * np.exp(-rate * t)
    return numerator / (rate**2 + omega**2)


def along_x(speed: np.ndarray) -> np.ndarray:
    return np.column_stack([speed, np.zeros_like(speed), np.zeros_like(speed)])


def driving_force(scene: Scene, frequency: float) -> float:
    """Force per mass along x, m/s2: of [gravity], or of the pressures at both ends. Checks the waveform."""
    if scene.has("gravity"):
        scene.expect_waveform("gravity", lambda t: math.cos(2.0 * math.pi * frequency * t))
        return scene.vector("gravity.acceleration")[0]
    low, high = scene.box
    pressures = {scene.text(f"{end}.side"): scene.number(f"{end}.pressure") for end in ("inflow", "outflow")}
    drop = pressures["left"] - pressures["right"]
    return drop / (scene.number("fluid.density") * (high[0] - low[0]))


class ForcedChannel:
    """Plane channel of no-slip walls at rest, from rest, under a force g cos(2 pi f t) along x.

    f = 0: start-up Poiseuille flow (Batchelor, An Introduction to Fluid Dynamics, section 4.3); else
    Womersley's flow (J. Physiol. 127, 1955) in a channel, with the transient of its start. Eigenfunctions:
    u = sum over odd n of (4 g / n pi) T_n(t) sin(n pi y / H), rate nu (n pi / H)^2.
    """

    def __init__(self, scene: Scene, frequency: float = 0.0):
        low, high = scene.box
        self.floor, self.height = low[1], high[1] - low[1]
        self.nu = scene.kinematic_viscosity
        self.frequency = frequency
        self.force = driving_force(scene, frequency)

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        n = 2.0 * np.arange(TERMS) + 1.0
        rate = self.nu * (n * math.pi / self.height) ** 2
        amplitude = 4.0 * self.force / (n * math.pi) * response(rate, self.frequency, t)
        angle = math.pi / self.height * (places[:, 1] - self.floor)
        return along_x(np.sin(np.outer(angle, n)) @ amplitude)

    @property
    def womersley_number(self) -> float:
        return 0.5 * self.height * math.sqrt(2.0 * math.pi * self.frequency / self.nu)


class ForcedPipe:
    """Circular pipe along x, from rest, under a force g cos(2 pi f t) along x.

    f = 0: start-up Hagen-Poiseuille flow (Szymanski 1932; Batchelor, section 4.3); else Womersley's flow with the
    transient of its start. u = sum of 2 g / (j J1(j)) T(t) J0(j r / R) over the zeros j of J0, rate nu (j/R)^2.
    """

    def __init__(self, scene: Scene, centre: list, radius: float, frequency: float = 0.0):
        self.centre, self.radius = np.asarray(centre, dtype=float), radius
        self.nu = scene.kinematic_viscosity
        self.frequency = frequency
        self.force = driving_force(scene, frequency)
        self.zeros = special.jn_zeros(0, TERMS)

    def _response(self, t: float) -> np.ndarray:
        return response(self.nu * (self.zeros / self.radius) ** 2, self.frequency, t)

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        r = np.hypot(places[:, 1] - self.centre[0], places[:, 2] - self.centre[1]) / self.radius
        amplitude = 2.0 * self.force / (self.zeros * special.j1(self.zeros)) * self._response(t)
        return along_x(np.where(r < 1.0, special.j0(np.outer(r, self.zeros)) @ amplitude, 0.0))

    def mean_velocity(self, t: float) -> float:
        """Flow over area, m/s: 2 int u r dr / R^2."""
        return float(np.sum(4.0 * self.force / self.zeros**2 * self._response(t)))


class ImposedParabola:
    """Steady plane Poiseuille flow of the mean velocity that [inflow] imposes: u = 6 U y (H - y) / H^2."""

    def __init__(self, scene: Scene):
        low, high = scene.box
        self.floor, self.height = low[1], high[1] - low[1]
        self.mean = scene.number("inflow.mean_velocity")

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        y = (places[:, 1] - self.floor) / self.height
        return along_x(6.0 * self.mean * y * (1.0 - y))


class StartUpCouette:
    """The upper wall moves with speed U from t = 0 on, the lower one is at rest (Batchelor, section 4.3).

    u = U y / H + sum over n of (2 U / n pi) (-1)^n exp(-nu (n pi / H)^2 t) sin(n pi y / H).
    """

    def __init__(self, scene: Scene):
        low, high = scene.box
        self.floor, self.height = low[1], high[1] - low[1]
        self.nu = scene.kinematic_viscosity
        scene.expect_waveform("wall_motion.top", lambda t: 1.0)
        self.speed = scene.vector("wall_motion.top.velocity")[0]

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        n = np.arange(TERMS) + 1.0
        eta = (places[:, 1] - self.floor) / self.height
        decay = np.exp(-self.nu * (n * math.pi / self.height) ** 2 * t)
        amplitude = 2.0 / (n * math.pi) * (-1.0) ** n * decay
        return along_x(self.speed * (eta + np.sin(np.outer(math.pi * eta, n)) @ amplitude))


class CarreauYasudaChannel:
    """Steady plane channel of a Carreau-Yasuda fluid under a force g along x, between walls at rest.

    The stress is known, mu(G) G = rho g (H/2 - y) on the lower half, G = du/dy; solved for G at each of the nodes of
    a fine grid and summed by trapezia. mu(G) = m + (mu0 - m) (1 + (t G)^a)^((n - 1)/a): Yasuda et al. 1981.
    """

    NODES = 4001  # both rules leave less than 1e-7 of the peak

    def __init__(self, scene: Scene):
        low, high = scene.box
        self.floor, self.height = low[1], high[1] - low[1]
        table = "viscosity.carreau_yasuda"
        self.rest, self.high = scene.number("viscosity.dynamic"), scene.number(f"{table}.high_shear")
        self.time = scene.number(f"{table}.relaxation_time")
        self.power, self.transition = scene.number(f"{table}.power"), scene.number(f"{table}.transition")
        self.push = scene.number("fluid.density") * driving_force(scene, 0.0)
        self.nodes = np.linspace(0.0, 0.5 * self.height, self.NODES)
        self.speeds = integrate.cumulative_trapezoid(
            [self.shear_rate(self.push * (0.5 * self.height - y)) for y in self.nodes], self.nodes, initial=0.0)

    def viscosity(self, rate: float) -> float:
        thinned = (1.0 + (self.time * rate) ** self.transition) ** ((self.power - 1.0) / self.transition)
        return self.high + (self.rest - self.high) * thinned

    def shear_rate(self, stress: float) -> float:
        """The rate at which the fluid bears `stress` (Pa), 1/s."""
        size = abs(stress)
        least = min(self.rest, self.high)
        if size == 0.0:
            return 0.0
        rate = optimize.brentq(lambda g: self.viscosity(g) * g - size, 0.0, size / least * 1.001, xtol=1e-14)
        return math.copysign(rate, stress)

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        y = places[:, 1] - self.floor
        return along_x(np.interp(np.minimum(y, self.height - y), self.nodes, self.speeds))


class Rest:
    """A heavy fluid at rest in a closed box: no velocity, p = rho g.(x - x0)."""

    def __init__(self, scene: Scene):
        self.gravity = scene.vector("gravity.acceleration")
        self.density = scene.number("fluid.density")
        self.origin = scene.box[0]

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        return np.zeros_like(places)

    def pressure(self, places: np.ndarray, t: float) -> np.ndarray:
        return self.density * (places - self.origin) @ self.gravity


class TaylorGreen:
    """Taylor's decaying vortices (Phil. Mag. 46, 1923) in a periodic square of side L with top speed U at t = 0.

    u = U (sin kx cos ky, -cos kx sin ky) exp(-2 nu k^2 t), k = 2 pi / L; p = rho U^2/4 (cos 2kx + cos 2ky) e^2.
    """

    def __init__(self, scene: Scene, speed: float = 1.0):
        low, high = scene.box
        self.side, self.k = high[0] - low[0], 2.0 * math.pi / (high[0] - low[0])
        self.speed, self.nu, self.density = speed, scene.kinematic_viscosity, scene.number("fluid.density")

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        x, y = self.k * places[:, 0], self.k * places[:, 1]
        u = np.column_stack([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y), np.zeros_like(x)])
        return self.speed * math.exp(-2.0 * self.nu * self.k**2 * t) * u

    def pressure(self, places: np.ndarray, t: float) -> np.ndarray:
        x, y = self.k * places[:, 0], self.k * places[:, 1]
        fall = math.exp(-4.0 * self.nu * self.k**2 * t)
        return 0.25 * self.density * self.speed**2 * (np.cos(2.0 * x) + np.cos(2.0 * y)) * fall

    def kinetic_energy(self, t: np.ndarray) -> np.ndarray:
        """Per depth, J/m."""
        fall = np.exp(-4.0 * self.nu * self.k**2 * np.asarray(t))
        return 0.25 * self.density * (self.speed * self.side) ** 2 * fall


class TriPeriodicVortices:
    """Taylor's vortices carried to three dimensions: Antuono, J. Fluid Mech. 890, A23 (2020), positive helicity.

    A Beltrami flow, curl u = sqrt(3) k u, so that its shape stays and it decays as exp(-3 nu k^2 t) for all time: an
    exact judge of a fully three-dimensional flow, which the classical Taylor-Green vortex has not.
    """

    def __init__(self, scene: Scene, speed: float = 1.0):
        low, high = scene.box
        self.side, self.k = high[0] - low[0], 2.0 * math.pi / (high[0] - low[0])
        self.speed, self.nu, self.density = speed, scene.kinematic_viscosity, scene.number("fluid.density")

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        columns = [self._component(*(self.k * places[:, (d, (d + 1) % 3, (d + 2) % 3)]).T) for d in range(3)]
        amplitude = self.speed * 4.0 * math.sqrt(2.0) / (3.0 * math.sqrt(3.0))
        return amplitude * math.exp(-3.0 * self.nu * self.k**2 * t) * np.column_stack(columns)

    @staticmethod
    def _component(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        first, second = 5.0 * math.pi / 6.0, math.pi / 6.0
        return (np.sin(x - first) * np.cos(y - second) * np.sin(z)
                - np.cos(z - first) * np.sin(x - second) * np.sin(y))

    def kinetic_energy(self, t: np.ndarray) -> np.ndarray:
        """In J. The mean of |u|^2 is U^2: of each component amplitude^2 (1/8 + 1/8 + 1/32) = 1/3 U^2."""
        return 0.5 * self.density * self.side**3 * self.speed**2 * np.exp(-6.0 * self.nu * self.k**2 * np.asarray(t))


class TaylorGreenSeries:
    """The classical vortex of Taylor and Green (Proc. R. Soc. A 158, 1937) for short times.

    u(0) = U (sin kx cos ky cos kz, -cos kx sin ky cos kz, 0). The power series in t of the Navier-Stokes equations,
    as in that paper, but in Fourier coefficients on a grid that holds every product exactly.
    """

    ORDER, GRID = 12, 32  # order n has wave numbers up to n + 1, products up to 2 (n + 1) / 2 + 1 < GRID / 2

    def __init__(self, scene: Scene, speed: float = 1.0):
        low, high = scene.box
        self.side, self.k = high[0] - low[0], 2.0 * math.pi / (high[0] - low[0])
        self.speed, self.density = speed, scene.number("fluid.density")
        self.terms = taylor_green_terms(scene.kinematic_viscosity * self.k / speed, self.ORDER, self.GRID)

    def _coefficients(self, t: float) -> np.ndarray:
        tau = self.speed * self.k * t
        return sum(term * tau**n for n, term in enumerate(self.terms))

    def velocity(self, places: np.ndarray, t: float) -> np.ndarray:
        field = np.real(np.fft.ifftn(self._coefficients(t), axes=(1, 2, 3), norm="forward"))
        return self.speed * np.column_stack([periodic_value(c, places / self.side) for c in field])

    def kinetic_energy(self, t: np.ndarray) -> np.ndarray:
        """In J."""
        density = np.array([np.sum(np.abs(self._coefficients(one)) ** 2) for one in np.atleast_1d(t)])
        return 0.5 * self.density * self.side**3 * self.speed**2 * density

    def last_term(self, t: float) -> float:
        """Size of the last term kept against the whole: what cutting the series costs, about."""
        last = self.terms[-1] * (self.speed * self.k * t) ** (len(self.terms) - 1)
        return float(np.linalg.norm(last) / np.linalg.norm(self._coefficients(t)))


def periodic_value(field: np.ndarray, places: np.ndarray) -> np.ndarray:
    """A band-limited periodic field on a grid of the unit cube at any places, by the Fourier sum of its axes."""
    n = field.shape[0]
    wave = np.fft.fftfreq(n, 1.0 / n)
    coefficients = np.fft.fftn(field, norm="forward")
    keep = [np.flatnonzero(np.max(np.abs(coefficients), axis=tuple(a for a in range(3) if a != d)) > 1e-13)
            for d in range(3)]
    small = coefficients[np.ix_(*keep)]
    phase = [np.exp(2j * math.pi * np.outer(places[:, d], wave[keep[d]])) for d in range(3)]
    values = np.empty(len(places))
    for first in range(0, len(places), 4096):
        part = slice(first, first + 4096)
        values[part] = np.real(np.einsum("pi,pj,pk,ijk->p", *(p[part] for p in phase), small, optimize=True))
    return values


@functools.cache
def taylor_green_terms(viscosity: float, order: int, grid: int) -> list:
    """Fourier coefficients (3, grid, grid, grid) of u_n in u = sum u_n t^n, on the cube of side 2 pi, U = 1.

    (n + 1) u_{n+1} = P(-sum_m (u_m . grad) u_{n-m}) + nu laplacian u_n, P the projection on solenoidal fields.
    """
    one = 2.0 * math.pi * np.arange(grid) / grid
    x, y, z = np.meshgrid(one, one, one, indexing="ij")
    start = [np.sin(x) * np.cos(y) * np.cos(z), -np.cos(x) * np.sin(y) * np.cos(z), 0.0 * x]
    wave = np.stack(np.meshgrid(*3 * [np.fft.fftfreq(grid, 1.0 / grid)], indexing="ij"))
    square = np.sum(wave**2, axis=0)
    axes = (1, 2, 3)
    terms = [np.fft.fftn(np.stack(start), axes=axes, norm="forward")]
    fields = [np.stack(start)]
    gradients = []
    for n in range(order):
        gradients.append(np.stack([np.real(np.fft.ifftn(1j * wave[d] * terms[n], axes=axes, norm="forward"))
                                   for d in range(3)]))  # [derivative, component]
        carried = sum(np.einsum("dxyz,dcxyz->cxyz", fields[m], gradients[n - m]) for m in range(n + 1))
        push = -np.fft.fftn(carried, axes=axes, norm="forward")
        push -= wave * np.sum(wave * push, axis=0) / np.where(square > 0.0, square, 1.0)
        terms.append((push - viscosity * square * terms[n]) / (n + 1))
        fields.append(np.real(np.fft.ifftn(terms[n + 1], axes=axes, norm="forward")))
    return terms


SOLUTIONS = {
    "forced_channel": ForcedChannel,
    "forced_pipe": ForcedPipe,
    "imposed_parabola": ImposedParabola,
    "start_up_couette": StartUpCouette,
    "carreau_yasuda_channel": CarreauYasudaChannel,
    "rest": Rest,
    "taylor_green": TaylorGreen,
    "tri_periodic_vortices": TriPeriodicVortices,
    "taylor_green_series": TaylorGreenSeries,
}


def solution(name: str, scene: Scene, parameters: dict):
    if name not in SOLUTIONS:
        raise SceneMismatch(f"there is no exact solution '{name}'; there are: {', '.join(SOLUTIONS)}")
    return SOLUTIONS[name](scene, **parameters)
