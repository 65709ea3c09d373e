#!/usr/bin/env python3
"""Whether the tables of src/checks/README.md are those of today: checks_page.py SOURCE [--write].

Its accuracy is that of the last row of each problem in tests/verification.txt. Every row of its other tables has to stand
in the page that the section links. --write renews the accuracy."""
import os
import re
import sys


def last_rows(text):
    """By problem: cells, errors by name, order; of its last row, the finest grid."""
    rows = {}
    for line in text.splitlines():
        words = line.split()
        if len(words) < 15 or words[0] in ("#", "problem", "missed:"):
            continue
        errors = {words[k]: words[k + 1] for k in range(15, len(words) - 1) if re.match(r"[a-z]\w*$", words[k])}
        errors["depth"] = words[6]
        rows[words[0]] = (words[2], errors, words[14])
    return rows


def figures(error):
    """Two digits, as a reader wants them: 0.0016, 7.4e-8."""
    number = abs(float(error))
    if number == 0.0:
        return "0"
    if number >= 1e-4:
        return f"{float(f'{number:.1e}'):.6f}".rstrip("0")
    return re.sub(r"e-0", "e-", f"{number:.1e}")


def renewed(page, table):
    rows = last_rows(table)

    def row(found):
        what, problem, of = found.groups()
        cells, errors, order = rows[problem]
        name = of.split()[0].strip("`")
        if name not in errors or errors[name] == "-":
            raise SystemExit(f"{problem} has no error of {name} in tests/verification.txt")
        order = f" {order}" if name == "depth" else ""
        return f"| {what}`{problem}` | {of} | {cells} | {figures(errors[name])} |{order} |"
    page, count = re.subn(r"^\| (.*)`(\w+)` \| (`?\w+`?(?: \[m/s\])?) \| \d+ \| [\d.e-]+ \|.*\|$", row, page, flags=re.M)
    accuracy = page.split("\n## ")[1]
    rows_there = sum(line.startswith("|") for line in accuracy.splitlines()) - 2
    if count != rows_there:
        raise SystemExit(f"src/checks/README.md: found {rows_there} rows of accuracy, of which {count} can be read; "
                         "expected what, problem, error's name, cells, error, order")
    missed = len(re.findall(r"^missed", table, re.M))
    return re.sub(r"Goals that are missed: \d+\.", f"Goals that are missed: {missed}.", page)


def copied_wrong(page, folder):
    for section in page.split("\n## ")[2:]:
        with open(os.path.join(folder, re.search(r"\]\((\w+/README\.md)\)", section).group(1)), encoding="utf-8") as file:
            source = file.read().splitlines()
        rows = [line for line in section.splitlines() if line.startswith("|") and not line.startswith("|---")]
        if len(rows) < 4:
            yield f"{section.split()[0]}: found {len(rows)} rows; expected some of {folder}"
        yield from (f"stands on no other page: {line}" for line in rows if line not in source)


def main():
    source = sys.argv[1] if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else os.path.dirname(
        os.path.dirname(os.path.abspath(__file__)))
    folder = os.path.join(source, "src", "checks")
    place = os.path.join(folder, "README.md")
    with open(place, encoding="utf-8") as file:
        page = file.read()
    with open(os.path.join(source, "tests", "verification.txt"), encoding="utf-8") as file:
        new = renewed(page, file.read())
    if "--write" in sys.argv:
        with open(place, "w", encoding="utf-8") as file:
            file.write(new)
        page = new
    wrong = [f"is old: {old}" for old, now in zip(page.splitlines(), new.splitlines()) if old != now]
    wrong += copied_wrong(page, folder)
    print("\n".join(wrong) if wrong else "the page is that of today")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
