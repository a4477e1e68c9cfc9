"""Texts that try to leave their place in a page, a plot or a file name."""

import json

HOSTILE = ['<script>document.title="owned"</script>', '"><img src=x onerror=alert(1)>', "</style><b>", "' onclick='x",
           "javascript:alert(1)", "$\\frac{$ & {{ 7*7 }} {% raw %}", "../../escaped"]


def make_hostile(folder):
    """Replaces every text of an experiment that a report could show."""
    bad = dict(zip(("iso_raymarch", "dvr_raymarch", "dvr_temporal"), (HOSTILE[0], HOSTILE[2], HOSTILE[5])))
    everything = "".join(HOSTILE)

    def labels_of(labels):
        return {("step" + HOSTILE[1] if k == "step" else k): bad.get(v, v + HOSTILE[4] if k == "scene" else v)
                for k, v in labels.items()}

    path = folder / "experiment.json"
    document = json.loads(path.read_text())
    for name in ("name", "title", "description", "config_file", "profile", "created"):
        document[name] += everything
    document["assignments"] = HOSTILE
    document["scenario"] = {everything: everything}
    document["axes"] = ["technique", "scene", "step" + HOSTILE[1]]
    document["program"] = {"version": "<i>", "commit": "<u>"}
    for point in document["points"]:
        point["labels"] = labels_of(point["labels"])
    path.write_text(json.dumps(document))
    for path in folder.glob("runs/*/[!.]*/run.json"):
        document = json.loads(path.read_text())
        document["labels"] = labels_of(document["labels"])
        document["reason"] += everything if document["reason"] else ""
        document["config"]["scene"] += HOSTILE[4]
        document["config"]["technique"]["parameters"] = {HOSTILE[0]: HOSTILE[1]}
        technique = document["technique"]
        technique["name"] = bad[technique["name"]]
        technique |= {key: everything for key in ("summary", "paper", "section")}
        for entry in technique["passes"] + technique["generation"] + technique["counters"]:
            entry["documentation"] = everything
        for entry in document["checks"]:
            entry |= {"passed": False, "detail": everything}
        document["provenance"]["host"] |= {"cpu": everything, HOSTILE[2]: HOSTILE[1]}
        document["provenance"]["device"] |= {"name": everything, "driver_info": HOSTILE[0]}
        if "counters" in document:
            document["counters"] = {HOSTILE[6] if k == "samples" else k: v for k, v in document["counters"].items()}
            counters = path.parent / "counters.csv"
            counters.write_text(counters.read_text().replace("samples", HOSTILE[6]))
        path.write_text(json.dumps(document))
