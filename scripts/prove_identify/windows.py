# SPDX-License-Identifier: MIT
"""Windows of 5 and 10 s of logs of real robots, and the whole logs, against the ratios of their data sheets.

A window that answers "no line above X" is held against the longer windows that hold it, up to the whole log.
"""

from . import answer, real, studies, tables


def answers(options):
    """(window, answer) of all windows; a text in place of an answer where the program fails."""
    made = []
    for window in real.windows(options.logs):
        try:
            made.append((window, answer.identify(options.program, window.csv())))
        except answer.Failed as failure:
            made.append((window, str(failure)))
    return made


def exceeded(window, found, rows):
    """(order, amplitude) of the largest line over 1.3 X that a longer window around this one has in the searched range."""
    lines = [line for other, longer in rows if not isinstance(longer, str) and (other.log, other.joint) == (window.log, window.joint) and
             other.time[0] <= window.time[0] and other.time[-1] >= window.time[-1] and other.length != window.length
             for line in longer.lines if line["order_output"] and line["amplitude_nm"] > 1.3 * (found.bound_at(line["order_output"]) or float("inf"))]
    return max(((line["order_output"], line["amplitude_nm"]) for line in lines), key=lambda line: line[1], default=None)


def counted(of, rows, notes):
    """The numbers of one line of the table."""
    counts = dict.fromkeys(("right", "wrong", "undecided", "probable", "covers", "given", "silent", "exceeded", "false", "failed"), 0)
    for window, found in of:
        if isinstance(found, str):
            counts["failed"] += 1
            notes.append(f"{window.name()}: {found}")
            continue
        if found.says_nothing() and found.bound_nm():
            counts["silent"] += 1
            worst = exceeded(window, found, rows)
            if worst:
                counts["exceeded"] += 1
                notes.append(f"{window.name()}: no line above {found.bound_at(worst[0]):.3g} Nm, but {worst[1]:.3g} Nm at order {worst[0]:.1f} in a "
                             "longer window")
        counts["false"] += bool(found.lines) and window.log in real.SILENT
        if not window.ratio:
            continue
        counts["probable"] += bool(found.rivals) and studies.is_gear(found.rivals[0][1], window.ratio)
        match = "undecided"
        if found.ratio:
            counts["given"] += 1
            counts["covers"] += found.interval[0] <= window.ratio <= found.interval[1] if found.interval else 0
            if found.conclusive:
                match = "right" if studies.is_gear(found.ratio, window.ratio) else "wrong"
                if match == "wrong":
                    notes.append(f"{window.name()}: {found.verdict}")
        counts[match] += 1
    return counts


def table(options):
    rows, notes, body = answers(options), [], []
    for length in real.WINDOWS_S:
        for log in ("all", *dict.fromkeys(window.log for window, _ in rows)):
            of = [(window, found) for window, found in rows if window.length == length and log in ("all", window.log)]
            if of:
                n = counted(of, rows, notes if log == "all" else [])
                body.append([f"{log}{':' if log == 'all' else ','} {'whole' if length is None else f'{length:g} s'}", str(len(of)),
                             *(str(n[key]) for key in ("probable", "right", "wrong", "undecided")),
                             f"{n['covers']} of {n['given']}", *(str(n[key]) for key in ("silent", "exceeded", "false", "failed"))])
    told = [(found.rivals[0][0], studies.is_gear(found.rivals[0][1], window.ratio)) for window, found in rows
            if window.ratio and not isinstance(found, str) and found.rivals]
    heads = ["log", "windows", "most probable right", "right", "wrong", "undecided", "interval covers data sheet", "\"no line\"",
             "exceeded", "false lines", "failed"]
    if not options.page:
        print("".join(f"* {note}\n" for note in notes))
    return tables.shown("identify-windows", "Each log", heads, body, (), ("failed",)) + "\n" + tables.calibration(told, "real windows")
