"""summary.json: the numbers of a run, units in their names."""

from dataclasses import asdict
from typing import Any

from workflow.estimates.comparison import estimates
from workflow.report.paper import rows
from workflow.results.results import Results
from workflow.run.log import machine, versions


def summary(results: Results, report_seconds: float) -> dict[str, Any]:
    """What summary.json holds. Stages without an answer stand under ``no_answer`` with their reason."""
    run = results.run
    data: dict[str, Any] = {
        "section": {"name": run.name, "sha256": run.sha256(), "reconstruction": run.reconstruction},
        "mesh": _mesh(results),
        "fem": _fem(results),
    }
    if results.variants is not None:
        kept = ("change", "kc", "kc_upper", "verdict")
        data["fem_variants"] = {v["name"]: {key: v[key] for key in kept} for v in results.variants["variants"]}
    if results.bounds is not None:
        data["bounds"] = {"lower": results.bounds["lower"], "upper": results.bounds["upper"]}
    if results.dem is not None:
        data["dem"] = _dem(results)
    name, cases = results.case_set()
    if cases:
        data["cases"] = {number: _case(case) for number, case in sorted(cases.items())}
        data["cases_springs"] = name
        others = {key: value for key, value in results.cases["sets"].items() if key != name} if results.cases else {}
        data |= {f"cases_{key}": {n: _case(c) for n, c in sorted(value.items())} for key, value in others.items()}
        if results.cases and results.cases.get("random"):
            data["cases_random"] = results.cases["random"]
    data["comparison"] = [asdict(estimate) for estimate in estimates(run, results.kc)]
    paper = rows(results)
    if paper:
        data["paper"] = [asdict(row) for row in paper]
    data["no_answer"] = {
        stage: {"reason": entry.reason, "remedy": entry.remedy}
        for stage in results.ends
        if (entry := results.no_answer(stage)) is not None
    }
    data["seconds"] = {name: entry.seconds for name, entry in results.ends.items()} | {
        "report": round(report_seconds, 2)
    }
    data["made_with"] = {"versions": versions(), **machine()}
    return data


def _mesh(results: Results) -> dict[str, Any] | None:
    if results.fem is not None:
        return {key: results.fem["mesh"][key] for key in ("quadrilaterals", "nodes", "method")}
    if "mesh" not in results.ends or results.no_answer("mesh"):
        return None
    from workflow.results.stored_mesh import stored_mesh

    mesh = stored_mesh(results.run, results.store)
    return {"quadrilaterals": len(mesh.cells), "nodes": len(mesh.points), "method": mesh.method}


def _fem(results: Results) -> dict[str, Any] | None:
    """Without a verdict there is no critical Kh, only the largest at which it was seen to stand."""
    answer = results.fem
    if answer is None:
        return None
    found = results.kc is not None
    flow = results.run.fem.flow
    return {
        "kc": answer["kc"] if found else None,
        "kc_lower": answer["kc_lower"],
        "kc_upper": answer["kc_upper"] if found else None,
        "verdict": answer["verdict"],
        "reason": answer["reason"],
        "dilation": "psi = phi" if flow == "associated" else answer["dilation_deg"],
        "sides": answer["settings"]["sides"],
        "element": answer["element"],
    }


def _dem(results: Results) -> dict[str, Any]:
    critical, calibration = results.dem, results.calibration
    assert critical is not None
    data = {
        "elements": critical["model"]["elements"],
        "boundary_elements": critical["model"]["boundary_elements"],
        "kc_table2": _springs_of_table2(critical),
        "kc": critical["after"]["kc"],
        "kc_lower": critical["after"]["kc_lower"],
        "kc_upper": critical["after"]["kc_upper"],
        "calibrated": None,
        "verdict": critical["after"]["verdict"],
    }
    if calibration is not None:
        data["calibrated"] = {"parameter": calibration["parameter"], "value": calibration["value"]}
        data["verdict"] = calibration["verdict"]
    return data


def _springs_of_table2(critical: dict[str, Any]) -> float | None:
    springs = critical["before"]["parameters"].get("springs")
    return critical["before"]["kc"] if springs == "table2" else None


def _case(case: dict[str, Any]) -> dict[str, Any]:
    lines = ("surface_before", "surface_after")
    return {key: value for key, value in case.items() if key not in lines}
