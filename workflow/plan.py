"""The runs behind the figures of [castillo2019] at one scale, by name, and what they cost.

The Snakefile asks for names and options, scripts/reproduce-paper for the hours. Nothing is run here.
"""

import math
import pathlib
import tomllib

import jobs

SCALES = ("small", "medium", "decide", "full")

EXPERIMENT_DENSITY = 1.1704  # grains per a^2: 11,704 in the cell of 100 a x 100 a
EXPERIMENT_OMEGA = 5.075  # sqrt(g/a): 80 Hz for spheres of 1 mm
LAYER_OMEGA = 5.0
LAYER_DENSITY = 0.9875  # grains per a^2
SLOW_EVERY = 8  # periods of 12.5 ms: 10 frames a second
FAST_EVERY = 0.16  # 500 frames a second
FIELD_STEP = 0.5  # t; its bias is below 1 % for k <= 1.2 (docs/field/schemes.md)
PLANE_SPACING = 0.65
LINE_SPACING = 0.25
KINDS = ("tracked", "true")  # films are analysed as the tracker found them, and as they were
LONG_KINDS = ("true", "box")  # a long run: plane waves as for films, and the modes between walls
LEAST_SECONDS = 2  # of any job: to start and to read


def text(number):
    """A number in a file name: the shortest text, never in powers of ten."""
    return f"{number:.6f}".rstrip("0").rstrip(".")


class Plan:
    """What is run at a scale. Names are those of the files: experiment-4.5, layer-2.2, plane-b4-0.002."""

    def __init__(self, scale, path=None):
        if scale not in SCALES:
            raise ValueError(f"unknown scale '{scale}'; there are {', '.join(SCALES)}")
        path = pathlib.Path(path) if path else pathlib.Path(__file__).parent / "scales.toml"
        with open(path, "rb") as file:
            scales = tomllib.load(file)
        self.scale = scale
        self.experiment = scales[scale]["experiment"]
        self.layer = scales[scale]["layer"]
        self.plane = scales[scale]["plane"]
        self.line = scales[scale]["line"]

    # ---- the walled cell, filmed ------------------------------------------------------------------

    def gammas(self):
        return [text(gamma) for gamma in self.experiment["gamma"]]

    def films(self, gamma=None):
        """The films of each acceleration: slow1, …, fast. Where there are long runs: long, which is
        not filmed, and slow1 and fast of some accelerations."""
        if "long-frames" in self.experiment:
            chosen = [(film, [text(value) for value in self.experiment.get(key, [])])
                      for film, key in [("slow1", "filmed-gamma"), ("fast", "fast-gamma")]]
            return ["long"] + [film for film, gammas in chosen if (gammas if gamma is None else gamma in gammas)]
        return [f"slow{i + 1}" for i in range(self.experiment["films"])] + ["fast"]

    def runs(self):
        """(acceleration, film) of all of them."""
        return [(gamma, film) for gamma in self.gammas() for film in self.films(gamma)]

    def kinds(self, film):
        return LONG_KINDS if film == "long" else KINDS

    def film_frames(self, film):
        return self.experiment[film + "-frames" if film in ("long", "fast") else "slow-frames"]

    def film_options(self, gamma, film):
        """Options of simulate md. The first film begins disordered, each other where slow1 or the one
        before it ended."""
        every, relax = self._every(film), self._relax(film)
        length = self.experiment["length"]
        return [f"--grains={self.experiment_grains()}", f"--length-x={length}", f"--length-y={length}",
                f"--amplitude={float(gamma) / EXPERIMENT_OMEGA**2:.6g}", f"--periods={self.film_periods(film):.6g}",
                f"--discard={relax}", f"--snapshot-every={every}"]

    def _every(self, film):
        return FAST_EVERY if film == "fast" else SLOW_EVERY

    def _relax(self, film):
        return self.experiment["relax"] if film in ("slow1", "long") else 0

    def film_periods(self, film):
        return self._relax(film) + self._every(film) * (self.film_frames(film) - 1)

    def film_before(self, gamma, film):
        """The film whose last frame this one begins with; None for the first."""
        films = self.films(gamma)
        place = films.index(film)
        return None if place == 0 or film == "slow1" else films[place - 1]

    def previews(self, gamma, film):
        """Frames kept for the report: a film to step through, and one frame of each other."""
        return 20 if film == self.films()[-1] and gamma == text(self.experiment["map-gamma"]) else 1

    def particle_fit_options(self, system, kind="true"):
        """Of analyze, for "experiment" or "layer": the range of the fit where it is not left to the
        pre-peak. Between walls plane waves are fitted, as in the paper; the modes that fit there stand
        beside them, or are fitted (kind "box")."""
        size = getattr(self, system)
        options = [f"--fit-k-max={size['k-max-fit']}"] if "k-max-fit" in size else []
        return options + (["--modes=plane-waves"] if system == "experiment" and kind != "box" else [])

    def diameter_px(self):
        return self.experiment["pixels"] / self.experiment["length"]

    def experiment_grains(self):
        return round(EXPERIMENT_DENSITY * self.experiment["length"] ** 2)

    # ---- the periodic layer ----------------------------------------------------------------------

    def layer_gammas(self):
        return [text(amplitude * LAYER_OMEGA**2) for amplitude in self.layer["amplitude"]]

    def layers(self):
        """Names of all layers, acceleration first: 2.3, and beside it 2.3-large, 2.3-literal, 2.3-literal-large."""
        beside = [f"{text(amplitude * LAYER_OMEGA**2)}-{kind}" for kind in ("large", "literal", "literal-large")
                  for amplitude in self.layer.get(f"amplitude-{kind}", [])]
        return self.layer_gammas() + beside

    def layer_length(self, name):
        return self.layer["length-large" if name.endswith("-large") else "length"]

    def layer_grains(self, name=""):
        return round(LAYER_DENSITY * self.layer_length(name) ** 2)

    def layer_options(self, name):
        length, relax = self.layer_length(name), self.layer["relax"]
        gamma = name.split("-")[0]
        # As the paper is worded: one coefficient for sticking and sliding.
        friction = [f"--{of}-static-friction=0.03" for of in ("grain", "plate")] if "-literal" in name else []
        return [f"--grains={self.layer_grains(name)}", f"--length-x={length}", f"--length-y={length}",
                f"--amplitude={float(gamma) / LAYER_OMEGA**2:.6g}", f"--discard={relax}",
                f"--periods={relax + self.layer['record']}",
                f"--snapshot-every={self.layer['snapshot-every']}"] + friction + self._contact_time()

    def _contact_time(self):
        """Without it a run ends where grains come to rest on the plate, near 1 g and with little friction."""
        return [f"--contact-time={self.layer['contact-time']:g}"] if "contact-time" in self.layer else []

    # ---- the field model -------------------------------------------------------------------------

    def fields(self):
        """Names of all field runs, those behind the figures first."""
        names = [f"plane-b4-{text(nu)}" for nu in self.plane["nu"]]
        names += [f"plane-b2-{text(nu)}" for nu in self.plane["nu-beside"]]
        names += [f"plane-b4-{text(nu)}-n{nx}" for nx, nu in self.plane.get("other-sizes", [])]
        return names + [f"line-b{b}-{text(nu)}" for b in (2, 4) for nu in self.line["nu"]]

    def field_nx(self, name):
        if "-n" in name:
            return int(name.rsplit("-n", 1)[1])
        return (self.plane if name.startswith("plane") else self.line)["nx"]

    def field_options(self, name):
        geometry, b, nu = name.split("-")[:3]
        size = self.plane if geometry == "plane" else self.line
        options = [f"--nx={self.field_nx(name)}", f"--b={b[1:]}", f"--nu={nu}", f"--dt={FIELD_STEP}",
                   f"--relax={size['relax']}", f"--record={size['record']}", "--k-max=3",
                   f"--sample={5 if geometry == 'plane' else 10}"]
        if geometry == "plane":
            return options + ["--dimension=2", f"--spacing={PLANE_SPACING}"]
        return options + ["--dimension=1", f"--spacing={LINE_SPACING}"]

    def fit_options(self, name):
        """Of analyze: a field has no pre-peak that could set the range; alpha as in the paper, 1.12 in
        the plane and 1.58 on a line."""
        plane = name.startswith("plane")
        size = self.plane if plane else self.line
        return [f"--fit-k-max={size['k-max-fit']}", f"--alpha={1.12 if plane else 1.58}"]

    # ---- what it costs ---------------------------------------------------------------------------

    def job(self, rule, gamma=None, film=None, kind=None, layer=None, name=None):
        """What a job of the Snakefile takes; the words are its wildcards. None: seconds, on the machine that starts
        the workflow."""
        del gamma, kind
        layer_grains = self.layer_grains(layer or "")
        grains, pixels = self.experiment_grains(), self.experiment["pixels"] ** 2
        if rule == "cell":
            return jobs.simulate_md(grains, self.film_periods(film), walls=True)
        if rule == "film":
            return jobs.render(self.film_frames(film), pixels, self.experiment["sub-frames"])
        if rule == "track":
            return jobs.track(self.film_frames(film), grains, pixels)
        if rule == "analyze_film":
            return jobs.analyze(self.film_frames(film), grains)
        if rule == "layer":
            return jobs.simulate_md(layer_grains, self.layer["relax"] + self.layer["record"], walls=False)
        if rule == "analyze_layer":
            return jobs.analyze(self.layer["record"] / self.layer["snapshot-every"], layer_grains)
        if rule in ("field", "analyze_field"):
            plane = name.startswith("plane")
            size = self.plane if plane else self.line
            sites = self.field_nx(name) ** (2 if plane else 1)
            if rule == "analyze_field":
                return jobs.Job(LEAST_SECONDS, jobs.simulate_field(sites, 0, 2).megabytes)
            return jobs.simulate_field(sites, (size["relax"] + size["record"]) / FIELD_STEP, 2 if plane else 1)
        return None

    def jobs(self):
        """(stage, rule, wildcards) of every job that is no matter of seconds."""
        cells = [{"gamma": gamma, "film": film} for gamma, film in self.runs()]
        films = [cell for cell in cells if cell["film"] != "long"]
        layers = [{"layer": layer} for layer in self.layers()]
        kinds = [{**cell, "kind": kind} for cell in cells for kind in self.kinds(cell["film"])]
        for stage, rule, runs in [("walled cell, molecular dynamics", "cell", cells), ("films", "film", films),
                                  ("tracking", "track", films), ("periodic layer, molecular dynamics", "layer", layers),
                                  ("field model", "field", [{"name": name} for name in self.fields()]),
                                  ("analysis", "analyze_film", kinds), ("analysis", "analyze_layer", layers)]:
            for wildcards in runs:
                yield stage, rule, wildcards

    def costs(self):
        """(stage, seconds of one core) of all that has to be done."""
        seconds = {}
        for stage, rule, wildcards in self.jobs():
            seconds[stage] = seconds.get(stage, 0) + self.job(rule, **wildcards).seconds
        return list(seconds.items())

    def hours(self, cores):
        """Expected hours by the clock, were all cores busy all the time."""
        return sum(seconds for _, seconds in self.costs()) / cores / 3600

    def gigabytes(self):
        """Disk for positions, and for the largest film, which goes when it is tracked (as does the
        simulation that was filmed: its positions are kept in pixels)."""
        frames = sum(self.film_frames(film) for _, film in self.runs())
        positions = frames * self.experiment_grains() * (72 + 80)
        layer = self.layer
        grains = sum(self.layer_grains(name) for name in self.layers())
        positions += grains * layer["record"] / layer["snapshot-every"] * 104
        film = max(self.film_frames(f) for f in self.films() if f != "long") * self.experiment["pixels"] ** 2
        return (positions + 2 * film) / 1e9


def table(plan, cores):
    """What will be done and how long it takes, for people."""
    lines = [f"{stage:<36} {seconds / 3600:>9.2f} h of one core" for stage, seconds in plan.costs()]
    hours = plan.hours(cores)
    clock = f"{hours:.1f} h" if hours >= 1 else f"{60 * hours:.0f} min"
    size = plan.gigabytes()
    lines.append(f"expected on {cores} core{'s' if cores != 1 else ''}: {clock}, "
                 f"{math.ceil(size) if size >= 1 else round(size, 1)} GB of disk")
    return "\n".join(lines)
