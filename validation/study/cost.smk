# The runs of a cost study, one job each, on one thread each; ./sprung study cost CASE calls it.
# A job is done when its answer stands in OUT/points; what was killed goes on from its last checkpoint. Every round
# runs each point once before the next begins: repeats of one point are spread over the study, so that a machine
# that slows down shows as spread. The same file runs on a cluster: --profile validation/study/slurm.
import hashlib
import sys
from pathlib import Path

ROOT = Path(workflow.basedir).parents[1]
sys.path.insert(0, str(ROOT / "validation" / "study"))
import plan as plans

CASE = ROOT / "validation" / config["case"]
OUT = config["out"]
QUICK = str(config.get("quick", "no")) == "yes"
PROGRAM = {"particles": config["sph"], "reference": config["reference"]}
PLAN = plans.read(CASE, QUICK)
RUN = f"/usr/bin/python3 -B {ROOT}/validation/study/run_point.py {CASE}"
# Several studies may share one reference: its runs are then found in TRUTH.
TRUTH = config.get("truth", f"{OUT}/truth")


def digest(*files):
    return hashlib.sha256(b"".join(Path(file).read_bytes() for file in files)).hexdigest()[:16]


STAMP = {solver: digest(PROGRAM[solver], PLAN.scene(solver)) for solver in {p.solver for p in PLAN.points}}
if PLAN.levels():
    STAMP["reference"] = digest(PROGRAM["reference"], PLAN.scene("reference"))
ROUNDS = max(point.repeats for point in PLAN.points)
LEVELS = [f"{TRUTH}/level_{k}.json" for k in range(len(PLAN.levels()))]


def answers(repeat):
    return [f"{OUT}/points/{point.name}.r{repeat}.json" for point in PLAN.points if point.repeats >= int(repeat)]


localrules: all, round


rule all:
    input:
        LEVELS,
        [f"{OUT}/rounds/{repeat}" for repeat in range(1, ROUNDS + 1)]


rule level:
    output:
        f"{TRUTH}/level_{{number}}.json"
    wildcard_constraints:
        number=r"\d"
    params:
        overrides=lambda wildcards: PLAN.levels()[int(wildcards.number)],
        program=STAMP.get("reference")
    priority: 1
    shell:
        "{RUN} truth.{wildcards.number} --program {PROGRAM[reference]} --out {output}"


rule point:
    input:
        lambda wildcards: f"{OUT}/rounds/{int(wildcards.repeat) - 1}" if int(wildcards.repeat) > 1 else []
    output:
        f"{OUT}/points/{{curve}}.{{number}}.r{{repeat}}.json"
    wildcard_constraints:
        curve=r"[^./]+",
        number=r"\d+",
        repeat=r"\d+"
    params:
        overrides=lambda w: list(PLAN.point(f"{w.curve}.{w.number}").overrides),
        program=lambda w: STAMP[PLAN.point(f"{w.curve}.{w.number}").solver],
        path=lambda w: PROGRAM[PLAN.point(f"{w.curve}.{w.number}").solver],
        limit=f"--time-limit {config['time_limit']}" if "time_limit" in config else ""
    shell:
        "{RUN} {wildcards.curve}.{wildcards.number} --repeat {wildcards.repeat} --program {params.path}"
        " --out {output} {params.limit}"


rule round:
    input:
        lambda wildcards: answers(wildcards.repeat)
    output:
        touch(f"{OUT}/rounds/{{repeat}}")
    wildcard_constraints:
        repeat=r"\d+"
