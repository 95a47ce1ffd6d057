#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The figures of README.md: a block between two comment lines, made from the tables of data/results.

    test/figures.py            writes the block
    test/figures.py --check    exit status 1 if it is not what this would write
"""
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
README = os.path.join(ROOT, 'README.md')
BEGIN, END = '<!-- written by test/figures.py -->\n', '<!-- end -->'


def read(path):
    with open(path, encoding='utf-8') as f:
        return f.read()


def rows(section):
    """The cells of every row of the tables of a section, by the first one."""
    text = read(os.path.join(ROOT, 'data/results/README.md'))
    begin = text.index(f'\n## {section}\n') + 1
    end = text.find('\n## ', begin)
    lines = [line for line in text[begin:end].split('\n') if line.startswith('| ')]
    cells = [[cell.strip() for cell in line.strip('|').split('|')] for line in lines]
    return {row[0]: row for row in reversed(cells)}  # the first of a name counts


def without_deviation(cell):
    """'0.06 (0.11) ± 0.02' -> '0.06 (0.11)'"""
    return cell.split(' ±')[0]


def mean_and_worst(cell):
    return [float(number) for number in re.match(r'([\d.]+) \(([\d.]+)\)', cell).groups()]


def block():
    flights = rows('The flights of the 2023 paper')['all']
    scenarios = {name: row for name, row in rows('Every scenario').items() if row[1].isdigit()}
    hover, ground, people, scene = (scenarios[name] for name in ('hover', 'rough-ground', 'people', 'scene'))
    drifts = [mean_and_worst(row[3]) for name, row in scenarios.items()
              if name not in ('hover', 'rough-ground', 'scene')]
    least, most = min(d[0] for d in drifts), max(d[0] for d in drifts)
    day = rows('A day in one go')
    error, sigma = day['24.00'][2].split(' / ')
    nees = day['position: largest NEES of a row'][1]
    ground_nees, people_nees, scene_nees = (row[5].split(' / ')[0] for row in (ground, people, scene))
    return f'''| simulated: error at the end, mean (worst) | `default` | `published-ekf` |
|---|---|---|
| seven flights of 128 to 175 m [% of the distance] | {without_deviation(flights[3])} | {without_deviation(flights[5])} |
| every scenario but the next three [%] | {least:.2f} to {most:.2f} ({max(d[1] for d in drifts):.2f}) | |
| 120 s of hover [m] | {without_deviation(hover[2])} | {without_deviation(hover[6])} |
| kart on rough ground, six points a scan [%] | {without_deviation(ground[3])}, NEES {ground_nees} | {without_deviation(ground[7])} |
| directions of all points off together by 3 deg, for 3 m of the way [%] | {without_deviation(scene[3])}, NEES {scene_nees} | {without_deviation(scene[7])} |
| NEES of the position beside people | {people_nees} | |
| 24 hours in one go: error / sigma [m] | {error} / {sigma}, largest NEES {nees} | |
'''


def main():
    text = read(README)
    begin = text.index(BEGIN) + len(BEGIN)
    end = text.index(END, begin)
    wanted = text[:begin] + '\n' + block() + '\n' + text[end:]
    if '--check' in sys.argv[1:]:
        if wanted != text:
            sys.exit('README.md: the figures are not those of data/results; test/figures.py writes them')
    elif wanted != text:
        with open(README, 'w', encoding='utf-8') as f:
            f.write(wanted)


if __name__ == '__main__':
    main()
