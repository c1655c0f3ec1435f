"""What compare.py has measured as Markdown: one table per scene, one over the size of scene C, and who wins where.

compare.py prints it, tables.py puts it into the documentation; neither octomarch nor a peer is needed.
"""

from typing import Any

Result = dict[str, Any]
Row = dict[str, Any]

MODES = {"depth": "primary rays", "shaded": "full shading"}
TITLES = {
    "A": "A: sphere and box, smoothly united, on a floor",
    "B": "B: tower minus repeated windows minus a shaft, on a floor",
    "C": "C: {n:,} balls, smoothly united",
}
_OK = ("first_seconds", "compile_seconds", "median", "quartiles", "fastest", "median_wall", "rounds", "error")


def check(result: Any, name: str) -> None:
    """Raise ValueError, naming file and key, where `result` is not what compare.py writes."""
    for key, kind in (("machine", dict), ("settings", dict), ("contenders", list), ("rows", list)):
        if not isinstance(result, dict) or not isinstance(result.get(key), kind):
            raise ValueError(f"{name}: {key!r} is missing or not a {kind.__name__}")
    known = {contender.get("key") for contender in result["contenders"]}
    for index, row in enumerate(result["rows"]):
        place = f"{name}: rows[{index}]"
        if row.get("contender") not in known:
            raise ValueError(f"{place}: unknown contender {row.get('contender')!r}")
        if row.get("mode") not in MODES or row.get("scene") not in TITLES or not isinstance(row.get("n"), int):
            raise ValueError(f"{place}: no such picture: {row.get('scene')!r}, {row.get('n')!r}, {row.get('mode')!r}")
        wanted = {"ok": _OK, "failed": ("reason",), "skipped": ("reason",)}.get(row.get("status"))
        if wanted is None:
            raise ValueError(f"{place}: unknown status {row.get('status')!r}")
        if missing := [key for key in wanted if key not in row]:
            raise ValueError(f"{place}: {', '.join(missing)} missing")


def labels(result: Result) -> dict[str, str]:
    return {contender["key"]: contender["label"] for contender in result["contenders"]}


def leading(result: Result) -> list[str]:
    """Return all peers, and octomarch on the best instruction set alone."""
    keys = list(labels(result))
    own = [key for key in keys if key.startswith("octomarch")]
    return [key for key in keys if key not in own or key.split("-")[1] == own[0].split("-")[1]]


def picture(result: Result, scene: str, n: int, mode: str) -> dict[str, Row]:
    """Return the rows of one picture by contender."""
    return {
        row["contender"]: row for row in result["rows"] if (row["scene"], row["n"], row["mode"]) == (scene, n, mode)
    }


def pictures(result: Result) -> list[tuple[str, int]]:
    """Return the scenes that have a table of their own, with the number of balls."""
    found = {(row["scene"], row["n"]) for row in result["rows"]}
    return sorted((scene, n) for scene, n in found if n in (0, result["settings"]["table_n"]))


def time(milliseconds: float) -> str:
    """Return three digits, and thousands apart."""
    if milliseconds >= 100:
        return f"{milliseconds:,.0f}"
    return f"{milliseconds:.1f}"


def _timing(row: Row | None) -> str:
    if row is None:
        return "–"
    if row["status"] != "ok":
        return str(row["status"])
    low, high = row["quartiles"]
    return f"{time(row['median'])} ({time(low)}–{time(high)})"


def _seconds(row: Row | None) -> str:
    return f"{row['compile_seconds']:.2f}" if row and row["status"] == "ok" else "–"


def _error(row: Row | None, mode: str) -> list[str]:
    count = 5 if mode == "depth" else 1
    error = row and row["status"] == "ok" and row["error"]
    if not error:
        return ["–"] * count
    if mode == "shaded":
        return [f"{error['p95']:.1e}"]
    percentiles = [f"{error[key]:.1e}" for key in ("p50", "p95", "p99")]
    return [*percentiles, str(error["false_hits"]), str(error["false_misses"])]


def bold(label: str) -> str:
    return f"**{label}**" if label.startswith("octomarch") else label


def scene_table(result: Result, scene: str, n: int) -> str:
    """Return the table of one scene, fastest primary rays first."""
    depth, shaded = (picture(result, scene, n, mode) for mode in MODES)
    names = labels(result)
    keys = sorted(
        (key for key in names if key in depth or key in shaded),
        key=lambda key: next((r["median"] for r in (depth.get(key), shaded.get(key)) if r and "median" in r), 1e99),
    )
    heads = [
        "",
        "primary rays, ms",
        "full shading, ms",
        "compile, s",
        "compile, shaded, s",
        "Δt p50",
        "Δt p95",
        "Δt p99",
    ]
    heads += ["false hits", "false misses", "Δ luminance p95"]
    lines = ["| " + " | ".join(heads) + " |", "|---|" + "---:|" * (len(heads) - 1)]
    for key in keys:
        first, second = depth.get(key), shaded.get(key)
        cells = [bold(names[key]), _timing(first), _timing(second), _seconds(first), _seconds(second)]
        lines.append("| " + " | ".join([*cells, *_error(first, "depth"), *_error(second, "shaded")]) + " |")
    return "\n".join(lines + remarks(result, scene, n))


def remarks(result: Result, scene: str, n: int) -> list[str]:
    """Return why rows have no figures, as a list below a table."""
    names, found = labels(result), []
    for mode, title in MODES.items():
        for key, row in picture(result, scene, n, mode).items():
            if row["status"] != "ok":
                found.append(f"- {names[key]}, {title}: {row['reason']}")
    return ["", *found] if found else []


def sizes(result: Result) -> list[int]:
    return sorted({row["n"] for row in result["rows"] if row["scene"] == "C"})


def sweep_table(result: Result) -> str:
    """Return milliseconds of primary rays against the number of balls."""
    ns, names = sizes(result), labels(result)
    columns = {n: picture(result, "C", n, "depth") for n in ns}
    keys = [key for key in names if sum(key in column for column in columns.values()) > 1]
    limit = f"> {result['settings']['limit_seconds']:.0f} s"
    lines = ["| balls | " + " | ".join(f"{n:,}" for n in ns) + " |", "|---|" + "---:|" * len(ns)]
    for key in keys:
        rows = [columns[n].get(key) for n in ns]
        cells = [
            "–"
            if not row
            else time(row["median"])
            if row["status"] == "ok"
            else limit
            if row["status"] == "skipped"
            else "failed"
            for row in rows
        ]
        lines.append(f"| {bold(names[key])} | " + " | ".join(cells) + " |")
    failed = [
        f"- {n:,} balls: {names[key]}: {row['reason']}"
        for n, column in columns.items()
        for key, row in column.items()
        if row["status"] == "failed"
    ]
    return "\n".join([*lines, *(["", *failed] if failed else [])])


def winners(result: Result) -> str:
    """Say for every picture who is fastest, and how octomarch does beside the best peer."""
    names, lines = labels(result), []
    for scene, n in pictures(result):
        for mode, title in MODES.items():
            rows = {key: row for key, row in picture(result, scene, n, mode).items() if row["status"] == "ok"}
            ours = [key for key in rows if key.startswith("octomarch")]
            others = [key for key in rows if key not in ours]
            if not ours or not others:
                continue
            own, peer = (min(keys, key=lambda key: rows[key]["median"]) for keys in (ours, others))
            ratio = rows[peer]["median"] / rows[own]["median"]
            verdict = f"{ratio:.2f} times the time of {names[own]}"
            who = f"**{names[peer]} wins**:" if ratio < 1 else f"the fastest peer is {names[peer]}:"
            lines.append(f"- {scene}, {title}: {who} {verdict} ({time(rows[peer]['median'])} ms).")
    return "\n".join(lines)


def how(result: Result) -> str:
    """Return on what and with what was measured."""
    machine, settings = result["machine"], result["settings"]
    busy, processors = machine.get("busy_processors_during", "an unknown number"), machine["processor"]["processors"]
    tabled = [row for row in result["rows"] if row["status"] == "ok" and row["n"] in (0, settings["table_n"])]
    rounds = sorted({row["rounds"] for row in tabled})
    width, height = settings["size"]
    return (
        f"{machine['processor']['model']}, {machine['date'][:10]}, octomarch {machine['octomarch']} at "
        f"{machine['commit']}, {width}×{height}, medians and quartiles of {'–'.join(map(str, rounds))} rounds, "
        f"milliseconds of processor time; other work kept {busy} of {processors} processors busy."
    )


def summary_table(result: Result) -> str:
    """Return one line per contender: both times in every scene, p95 of Δt in A, the longest compilation."""
    names, scenes = labels(result), pictures(result)
    columns = [picture(result, scene, n, mode) for scene, n in scenes for mode in MODES]
    heads = [f"{scene}: {n:,} balls" if n else scene for scene, n in scenes]
    lines = [
        "| ms, primary rays / full shading | " + " | ".join(heads) + " | Δt p95 in A | compile, s |",
        "|---|" + "---:|" * (len(scenes) + 2),
    ]
    for key, name in names.items():
        rows = [column.get(key) for column in columns]
        cells = [time(row["median"]) if row and row["status"] == "ok" else "–" for row in rows]
        pairs = [f"{first} / {second}" for first, second in zip(cells[::2], cells[1::2], strict=True)]
        good = [row["compile_seconds"] for row in rows if row and row["status"] == "ok"]
        error = next((row["error"] for row in rows if row and row.get("error")), None)
        accuracy = f"{error['p95']:.0e}" if error else "–"
        lines.append(f"| {bold(name)} | " + " | ".join([*pairs, accuracy, f"{max(good, default=0):.2f}"]) + " |")
    return "\n".join(lines + failures(result))


def failures(result: Result) -> list[str]:
    """Return why contenders have no figure in the scenes' tables, as a list below a table."""
    found = [line for scene, n in pictures(result) for line in remarks(result, scene, n) if line]
    return ["", *dict.fromkeys(found)] if found else []


def versions(result: Result) -> str:
    """Return what each contender is, and how it was set up."""
    lines = ["| | versions | set up as |", "|---|---|---|"]
    for contender in result["contenders"]:
        own = contender["key"].startswith("octomarch")
        packages = {"octomarch": result["machine"]["octomarch"]} if own else contender["versions"]
        listed = ", ".join(f"{name} {version}" for name, version in packages.items()) or "did not start"
        lines.append(f"| {bold(contender['label'])} | {listed} | {contender['flags']} |")
    return "\n".join(lines)


def tables(result: Result) -> str:
    """Return everything, with headings."""
    check(result, "the run")
    parts = [how(result)]
    for scene, n in pictures(result):
        parts += [f"### {TITLES[scene].format(n=n)}", scene_table(result, scene, n)]
    if len(sizes(result)) > 1:
        parts += ["### Scene C as it grows: primary rays, ms", sweep_table(result)]
    return "\n\n".join([*parts, "### Who wins", winners(result)])
