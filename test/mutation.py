#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Mutation testing: does a test notice when one thing in the core is wrong?

    test/mutation.py [--count 50] [--seed 1] [--room ROOM]... [--bodies] [--deep] [--jobs N]
                     [--results FILE] [--work DIR] [--list]

Draws mutants of include/rio/ROOM and src/ROOM (frontend, update, ekf, smoother, propagate, checks)
and, as the room "engine", of src/odometry/engine.*, scan_intake.* and include/rio/pipeline.hpp,
builds each in a copy of the sources and runs tests until one is red: those of the room, the one
named like the file first, then short flights, with --deep also the long ones. The golden file
(indication_test) notices any change, so it never counts; what only it sees is reported apart. The
outcome is a table of survivors with file, line and change, and the share killed.

The same seed draws the same mutants from the same sources. Every outcome is written to FILE as it
is found; called again, what stands there is not repeated, so a run can be stopped and continued.
Drawn are: a sign, a term or factor dropped, an operation or function swapped, a constant (times
two, halved, zero), a comparison or condition turned round. Not drawn are comments, assertions,
texts, sizes of types, bounds of loops, and zeros a member begins with. What does not compile is no
mutant; a test that does not end within --timeout has noticed. ccache makes it several times faster.
"""
import argparse
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
ROOMS = ['propagate', 'frontend', 'update', 'ekf', 'smoother', 'checks', 'engine']
# whose tests are run for a mutant of the room, in this order
NEXT = {'propagate': ['propagate', 'smoother'], 'frontend': ['frontend'], 'update': ['update', 'ekf'],
        'ekf': ['ekf', 'update'], 'smoother': ['smoother'], 'checks': ['checks'], 'engine': ['api']}
FLIGHT = ['api_engine_test', 'api_odometry_test', 'api_aiding_test', 'mc_accuracy_gate_test']
DEEP = ['api_contract_test', 'mc_recovery_test', 'mc_imu_fault_test', 'mc_calibration_test',
        'mc_consistency_test', 'api_allocation_test', 'e2e_recordings_test']
GOLDEN = 'indication_indication_test'
LABELS = ['unit', 'model', 'property', 'mc', 'e2e']

SKIP = re.compile(r'^\s*(#|//|using |namespace |template|static_assert|RIO_ASSERT|enum |case |'
                  r'class |struct |friend |public:|private:)|constexpr (int|std::size_t)|'
                  r'^\s*[\w:<>, ]+ \w+(\{|( = ))(0|0\.0|false|Time\{0\})?\}?;')
NUMBER = re.compile(r'(?<![\w.<\'"])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+|\d+)(?![\w.\'>])')
COMPARE = {' < ': ' >= ', ' > ': ' <= ', ' <= ': ' > ', ' >= ': ' < ', ' == ': ' != ',
           ' != ': ' == '}
SIGN = {' + ': ' - ', ' - ': ' + ', ' += ': ' -= ', ' -= ': ' += '}
SWAP = {'std::max(': 'std::min(', 'std::min(': 'std::max(', ' && ': ' || ', ' || ': ' && ',
        'std::sin(': 'std::cos(', 'std::cos(': 'std::sin(', '.minCoeff(': '.maxCoeff(',
        '.maxCoeff(': '.minCoeff(', ' * ': ' / ', ' / ': ' * ', '.cross(': '.cwiseProduct('}
DROP = ['.transpose()', '.conjugate()', '.inverse()', '.normalized()', 'std::abs']


def code_of(line):
    """The line with comments and texts blanked out, column by column."""
    line = re.sub(r'"(?:[^"\\]|\\.)*"', lambda m: ' ' * len(m.group()), line)
    at = line.find('//')
    return line if at < 0 else line[:at].rstrip('\n')


def term_after(code, at):
    """End of the operand that begins at `at`."""
    depth, i = 0, at
    while i < len(code):
        c = code[i]
        if c in '([{':
            depth += 1
        elif c in ')]}':
            if depth == 0:
                break
            depth -= 1
        elif depth == 0 and (c in ',;?:' or re.match(r' [-+*/<>=&|!?]+ ', code[i:])):
            if code[i:i + 2] == '::' or code[i - 1:i + 1] == '::':
                i += 1
                continue
            break
        i += 1
    return i


def closing(code, at):
    """Place of the bracket that closes the one before `at`."""
    depth = 1
    while at < len(code):
        depth += (code[at] in '([{') - (code[at] in ')]}')
        if depth == 0:
            break
        at += 1
    return at


def mutants_of_line(code):
    """(kind, begin, end, replacement) of everything that can be changed."""
    loop = re.match(r'\s*for \(', code) is not None
    for old, new in list(COMPARE.items()) + list(SIGN.items()) + list(SWAP.items()):
        kind = 'comparison' if old in COMPARE else 'sign' if old in SIGN else 'swap'
        if kind == 'comparison' and loop:
            continue
        for m in re.finditer(re.escape(old), code):
            yield kind, m.start(), m.end(), new
    for m in re.finditer(r'(?<=[(,=] )-(?=[\w(])|(?<=[(])-(?=[\w(])|(?<=return )-(?=[\w(])', code):
        yield 'sign', m.start(), m.end(), ''
    for m in re.finditer(r' [-+*/] ', code):
        if not loop and term_after(code, m.end()) < len(code):
            yield 'term', m.start(), term_after(code, m.end()), ''
    for old in DROP:
        for m in re.finditer(re.escape(old), code):
            yield 'term', m.start(), m.end(), ''
    for m in NUMBER.finditer(code):
        text = m.group()
        real = not text.isdigit()
        if re.search(r'<[^<>()]*$', code[:m.start()]) and '>' in code[m.end():]:
            continue  # the size of a type
        if loop and not real:
            continue
        value = float(text)
        new = {2.0 * value, 0.5 * value if real else value // 2, 0.0} if value else {1.0}
        for v in sorted(new - {value}):
            yield 'constant', m.start(), m.end(), repr(v) if real else str(int(v))
    for m in re.finditer(r'\b(if|while) \(', code):
        end = closing(code, m.end())
        if end < len(code) and ' = ' not in code[m.end():end] and 'constexpr' not in code:
            yield 'condition', m.start(), end, f'{m.group()}!({code[m.end():end]})'


def room_of(path):
    name = os.path.basename(path)
    whole = name.startswith(('engine.', 'scan_intake.')) or name == 'pipeline.hpp'
    return 'engine' if whole else os.path.basename(os.path.dirname(path))


def sites(rooms):
    """All mutants, in a fixed order."""
    found = []
    files = subprocess.run(['git', '-C', ROOT, 'ls-files', 'include/rio', 'src'], check=True,
                           capture_output=True, text=True).stdout.split()
    wanted = re.compile(r'(include/rio|src)/(propagate|frontend|update|ekf|smoother|checks)/|'
                        r'src/odometry/(engine|scan_intake)\.[ch]pp$|include/rio/pipeline\.hpp$')
    for path in sorted(files):
        if not wanted.match(path) or room_of(path) not in rooms:
            continue
        with open(os.path.join(ROOT, path), encoding='utf-8') as f:
            lines = f.read().split('\n')
        for number, line in enumerate(lines, 1):
            if SKIP.search(line) or 'RIO_ASSERT' in line or 'static_assert' in line:
                continue
            for kind, begin, end, new in mutants_of_line(code_of(line)):
                found.append({'file': path, 'line': number, 'kind': kind, 'old': line,
                              'new': line[:begin] + new + line[end:]})
    return found


def draw(found, count, seed):
    """Kinds alike often, whatever their number of places; a line only once a kind."""
    rng = random.Random(seed)
    by_kind = {}
    for m in found:
        by_kind.setdefault(m['kind'], []).append(m)
    seen = set()
    while by_kind and count > 0:
        kind = rng.choice(sorted(by_kind))
        m = by_kind[kind].pop(rng.randrange(len(by_kind[kind])))
        if not by_kind[kind]:
            del by_kind[kind]
        if (m['file'], m['line'], kind) in seen:
            continue
        seen.add((m['file'], m['line'], kind))
        count -= 1
        yield m


def tests_by_room():
    """Names of the test programs as test/CMakeLists.txt lists them, unit tests first."""
    rooms = {}  # programs of one test each, as without RIO_UNITY_BUILD
    with open(os.path.join(ROOT, 'test/CMakeLists.txt'), encoding='utf-8') as f:
        text = f.read()
    found = re.findall(r'^ *rio_test\(([\w/]+)\.cpp(?: LABEL (\w+))?', text, re.M)
    for arguments in re.findall(r'^ *rio_tests\(([^)]+)\)', text, re.M):
        arguments = re.sub(r' (LIBS|SHARDS).*', '', ' '.join(arguments.split()))
        names, _, label = arguments.partition(' LABEL ')
        folder, _, *names = names.split()
        found += [(f'{folder}/{name}_test', label) for name in names]
    for path, label in found:
        room = path.split('/')[0] if '/' in path else ''
        rank = LABELS.index(label) if label in LABELS else 0
        rooms.setdefault(room, []).append((rank, path.replace('/', '_')))
    return {room: [name for _, name in sorted(tests, key=lambda t: t[0])]
            for room, tests in rooms.items()}


class Bench:
    """A copy of the sources with its build folder."""

    def __init__(self, work, jobs, timeout):
        self.source = os.path.join(work, 'source')
        self.build = os.path.join(work, 'build')
        self.jobs, self.timeout = jobs, timeout
        self.green = set()
        self.sync()
        subprocess.run(['cmake', '-S', self.source, '-B', self.build, '-G', 'Ninja',
                        '-DCMAKE_BUILD_TYPE=None', '-DCMAKE_CXX_FLAGS=-O1',
                        '-DRIO_UNITY_BUILD=OFF', '-DRIO_BUILD_TOOLS=OFF', '-DRIO_BUILD_LAB=OFF',
                        '-DRIO_BUILD_EXAMPLES=OFF', '-DRIO_INSTALL=OFF'],
                       check=True, stdout=subprocess.DEVNULL)
        self.targets = set(re.findall(
            r'^(\w+_test):', subprocess.run(['ninja', '-C', self.build, '-t', 'targets', 'all'],
                                            check=True, capture_output=True, text=True).stdout,
            re.M))

    def sync(self):
        """Copies what differs; whatever an earlier run left behind is undone by that."""
        files = subprocess.run(['git', '-C', ROOT, 'ls-files', '-co', '--exclude-standard'],
                               check=True, capture_output=True, text=True).stdout.split('\n')
        for path in filter(None, files):
            source, target = os.path.join(ROOT, path), os.path.join(self.source, path)
            if not os.path.isfile(source):
                continue
            with open(source, 'rb') as f:
                content = f.read()
            if os.path.exists(target):
                with open(target, 'rb') as f:
                    if f.read() == content:
                        continue
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copy(source, target)

    def compile(self, target):
        return subprocess.run(['ninja', '-C', self.build, '-j', str(self.jobs), target],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0

    def passes(self, test):
        try:
            return subprocess.run([os.path.join(self.build, 'test', test),
                                   '--gtest_fail_fast', '--gtest_brief=1'],
                                  cwd=self.build, timeout=self.timeout, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL).returncode == 0
        except subprocess.TimeoutExpired:
            return False

    def write(self, path, number, line):
        name = os.path.join(self.source, path)
        with open(name, encoding='utf-8') as f:
            lines = f.read().split('\n')
        lines[number - 1] = line
        with open(name, 'w', encoding='utf-8') as f:
            f.write('\n'.join(lines))

    def judge(self, m, tests):
        """The first test that is red; '' = does not compile, 'golden', 'survived'."""
        self.write(m['file'], m['line'], m['new'])
        verdict = 'survived'
        try:
            if not self.compile('rio_core') or not self.compile('rio'):
                return ''
            for test in tests + [GOLDEN]:
                if not self.compile(test):
                    return ''
                if not self.passes(test):
                    verdict = 'golden' if test == GOLDEN else test
                    break
        finally:
            self.write(m['file'], m['line'], m['old'])
        if verdict != 'survived':
            test = GOLDEN if verdict == 'golden' else verdict
            if test not in self.green:
                if not self.compile(test) or not self.passes(test):
                    sys.exit(f'{test} is red without a mutant')
                self.green.add(test)
        return verdict


def tests_for(m, rooms, deep, targets):
    """In the order in which they are run."""
    room = room_of(m['file'])
    stem = os.path.splitext(os.path.basename(m['file']))[0]
    own = [t for r in NEXT[room] for t in rooms.get(r, [])]
    own.sort(key=lambda t: not t.endswith(f'_{stem}_test'))
    tests = own + FLIGHT + (DEEP if deep else [])
    return [t for i, t in enumerate(tests) if t in targets and t not in tests[:i]]


def table(outcomes):
    counted = [o for o in outcomes if o['verdict']]
    if not counted:
        return 'nothing judged'
    out = ['| file:line | kind | verdict | from | to |', '|---|---|---|---|---|']
    for o in counted:
        if o['verdict'] in ('survived', 'golden'):
            verdict = 'survived' if o['verdict'] == 'survived' else 'golden file only'
            text = [o[k].strip().replace('|', '\\|') for k in ('old', 'new')]
            out.append(f"| {o['file']}:{o['line']} | {o['kind']} | {verdict} | `{text[0]}` | "
                       f"`{text[1]}` |")
    out += ['', '| room | mutants | killed | golden file only | survived |', '|---|---|---|---|---|']
    for room in ROOMS + ['all']:
        of = [o for o in counted if room in ('all', room_of(o['file']))]
        golden = sum(o['verdict'] == 'golden' for o in of)
        alive = sum(o['verdict'] == 'survived' for o in of)
        if of:
            killed = len(of) - golden - alive
            out.append(f'| {room} | {len(of)} | {killed} ({100 * killed / len(of):.0f} %) | '
                       f'{golden} | {alive} |')
    return '\n'.join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--count', type=int, default=50)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--room', action='append', choices=ROOMS)
    parser.add_argument('--deep', action='store_true', help='the long tests, too')
    parser.add_argument('--bodies', action='store_true', help='no headers: these take minutes each')
    parser.add_argument('--jobs', type=int, default=os.cpu_count())
    parser.add_argument('--timeout', type=float, default=300.0, help='of a test [s]')
    parser.add_argument('--work', default=os.path.join(ROOT, 'build/mutation'))
    parser.add_argument('--results', help='default: WORK/results.jsonl')
    parser.add_argument('--list', action='store_true', help='what would be drawn')
    args = parser.parse_args()
    found = [m for m in sites(args.room or ROOMS)
             if not args.bodies or m['file'].endswith('.cpp')]
    drawn = draw(found, args.count, args.seed)
    if args.list:
        for m in drawn:
            print(f"{m['file']}:{m['line']} {m['kind']}\n  {m['old'].strip()}\n  {m['new'].strip()}")
        return
    results = args.results or os.path.join(args.work, 'results.jsonl')
    done = {}
    if os.path.exists(results):
        with open(results, encoding='utf-8') as f:
            done = {(o['file'], o['old'], o['new']): o for o in map(json.loads, f)}
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # leaves the copy as it was
    bench = Bench(args.work, args.jobs, args.timeout)
    rooms = tests_by_room()
    outcomes = []
    for i, m in enumerate(drawn, 1):
        key = (m['file'], m['old'], m['new'])
        if key not in done:
            m['verdict'] = bench.judge(m, tests_for(m, rooms, args.deep, bench.targets))
            done[key] = m
            with open(results, 'a', encoding='utf-8') as f:
                f.write(json.dumps(m) + '\n')
        o = dict(done[key], line=m['line'])
        outcomes.append(o)
        print(f"{i}/{args.count} {o['file']}:{o['line']} {o['kind']}: "
              f"{o['verdict'] or 'does not compile'}", file=sys.stderr, flush=True)
    print(table(outcomes))


if __name__ == '__main__':
    main()
