#!/usr/bin/env python3
"""What each constant of the averages over sizes does: errors and time with half and twice its value.

    tools/constants/vary.py BUILD [--work FOLDER] [--only NAME...] [--factors 0.5,2]

Without --only, constants that change time alone are left out.

BUILD is a configured and built tree (`build/native`), whose flags and libmiebrdf_math.a are taken.
A copy of mie/ is compiled in which the constants of the records in mie/ensemble and mie/sizes read
an environment variable; ensemble_battery (beside this script) measures the parts of the averages
that a constant may matter to. Printed are tables in Markdown: the errors as they are (in
tolerances; how many exceed the error stated), and what changes with each constant. Some minutes for
the copy, half a minute for each constant.
"""
import argparse, json, os, pathlib, re, shlex, subprocess, sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DECLARATION = re.compile(
    r'^(?P<indent> *)(?P<scope>static |inline )?constexpr (?P<type>double|float|int|std::size_t) '
    r'(?P<list>k\w+ =[^;{}]*);', re.M)
# Sizes of arrays and of registers, which change no more than rounding and time, and the constants
# of formats.
FIXED = {'kAnglesPerTile', 'kTileStep', 'kRegisters', 'kCount', 'kVectors', 'kPanelNodes', 'kNodes',
         'kTileRows', 'kGroup', 'kDiagonalsPerJob', 'kInterpolating', 'kPieceNodes', 'kPowers',
         'kRowsPerRate', 'kPiece', 'kEnds', 'kPi', 'kInfinity', 'kDegree', 'kBytesPerWave', 'kJobs',
         'kBothSamples', 'kPieceWaves', 'kMostSizesPerBlock', 'kMostRays', 'kMostRates',
         'kRegisterSize', 'kNumbers', 'kIncidences'}
# Memory, pieces for threads, limits of patience, rounding: they change time or nothing.
TIME_ALONE = {'kMostKept', 'kMostChunksOfSample', 'kLeastChunkOfSample', 'kMostColumns', 'kMostOfFunctions',
              'kTilesPerJob', 'kTilesWorthACopy', 'kMostChunks', 'kLeastChunk', 'kChunkMemory', 'kPartMemory',
              'kAnglesPerJob', 'kNodesAtOnce', 'kProductsPerSecond', 'kMostProducts', 'kMostPerPiece',
              'kMostTermsAtAngles', 'kJustAllowed', 'kRounding', 'kLeastLoss', 'kRoundedToNothing', 'kNegligible',
              'kNodeLimit', 'kLeastSingleTolerance', 'kLeastTableTolerance', 'kMomentsToJudge',
              'kDefaultTolerance', 'kPlateau', 'kRamp', 'kFinest', 'kLastLevel', 'kLeastTolerance', 'kBackward'}
# Spheroids, derivatives and whole laws of sizes are not in the battery.
NOT_MEASURED = ('spheroid_average.cpp', 'average_difference.cpp', 'mean_cross_section.cpp', 'size_laws.cpp')
VARY = '''#pragma once
#include <cmath>
#include <cstdlib>
#include <cstring>
template <typename T>
T vary(const char* name, T value) {
    const char* text = std::getenv("VARY");
    const std::size_t length = std::strlen(name);
    if (text == nullptr || std::strncmp(text, name, length) != 0 || text[length] != '*') return value;
    const double changed = double(value) * std::atof(text + length + 1);
    if (T(0.5) == T(0)) return T(std::lround(changed));
    return T(changed);
}
'''
PARTS = [(r'matrix_average|matrix_series', ['matrices']),
         (r'ray_average', ['averages', 'points', 'tables']),
         (r'exact_extinction|size_passes|moment_transform|ray_moments|size_nodes', ['averages', 'matrices']),
         (r'ensemble\.cpp|particle_ensemble', ['averages', 'tables', 'matrices']),
         (r'', ['points', 'tables'])]


def split(declarators):
    parts, depth = [''], 0
    for c in declarators:
        depth += (c in '([<') - (c in ')]>')
        if c == ',' and depth == 0: parts.append('')
        else: parts[-1] += c
    return [p.strip() for p in parts]


def changeable(text, file, found):
    """The source with constants that read the environment."""
    def replace(match):
        keep = []
        for part in split(match['list']):
            name, value = (s.strip() for s in part.split('=', 1))
            if name in FIXED: return match[0]
            found.append((file, name, ' '.join(value.split())))
            keep.append(f'{name} = vary<{match["type"]}>("{file}:{name}", {value})')
        scope = {'static ': 'static inline const', 'inline ': 'inline const', None: 'static const'}[match['scope']]
        return f'{match["indent"]}{scope} {match["type"]} ' + ', '.join(keep) + ';'
    changed = DECLARATION.sub(replace, text)
    return changed if changed == text else '#include "vary.h"\n' + changed


def compile_flags(build):
    for entry in json.load(open(build / 'compile_commands.json')):
        words = shlex.split(entry['command'])
        if any(w.endswith('cxx.o') and 'miebrdf_mie.dir' in w or w.endswith('cpp.o') and 'miebrdf_mie.dir' in w for w in words):
            kept = [w for w in words if w.startswith(('-D', '-O', '-m', '-std', '-f')) and w != '-fpch-preprocess']
            for flag in ('-I', '-isystem'):
                for i, w in enumerate(words):
                    if w == flag: kept += [flag, words[i + 1]]
                    elif w.startswith(flag) and w != flag and flag == '-I': kept.append(w)
            return kept
    sys.exit('no compile command of mie/ in ' + str(build))


def make_battery(build, work):
    found, sources = [], []
    for path in sorted(ROOT.glob('mie/**/*')):
        if path.suffix not in ('.cpp', '.h'): continue
        relative = path.relative_to(ROOT)
        text = path.read_text()
        if relative.parts[1] in ('ensemble', 'sizes') and relative.name not in NOT_MEASURED:
            text = changeable(text, relative.name, found)
        target = work / relative
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text() != text: target.write_text(text)
        if path.suffix == '.cpp': sources.append(target)
    (work / 'vary.h').write_text(VARY)
    flags = ['-I' + str(work), '-I' + str(work / 'mie/include')] + compile_flags(build)
    # As mie/CMakeLists.txt has it: several files at a time, but for those that share names.
    units = {'battery': [HERE / 'ensemble_battery.cpp']}
    for folder in ('sphere', 'spheroid', 'ensemble', 'sizes'):
        own = [s for s in sources if s.parent.name == folder]
        alone = [s for s in own if folder == 'sizes' or s.stem in ('radial_functions', 'far_rays')]
        units |= {f'{folder}_{s.stem}': [s] for s in alone}
        together = [s for s in own if s not in alone]
        for i in range(0, len(together), 5): units[f'{folder}_{i}'] = together[i:i + 5]
    objects = []
    for name, files in units.items():
        text = ''.join(f'#include "{f}"\n' for f in files)
        source, object_ = work / (name + '.cpp'), work / (name + '.o')
        objects.append(str(object_))
        newest = max(f.stat().st_mtime for f in [*files, *work.glob('mie/**/*.h')])
        if object_.exists() and object_.stat().st_mtime > newest: continue
        source.write_text(text)
        subprocess.run(['c++', *flags, '-w', '-c', str(source), '-o', str(object_)], check=True)
    program = work / 'ensemble_battery'
    subprocess.run(['c++', *objects, str(build / 'rte/math/libmiebrdf_math.a'), '-lfmt', '-o', str(program)], check=True)
    return program, found


def measure(program, truth, parts, vary=''):
    try:
        out = subprocess.run([str(program), str(truth), *parts], env={**os.environ, 'VARY': vary},
                             capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return None
    if out.returncode != 0: return None
    rows = [line.split(',') for line in out.stdout.splitlines()[1:]]
    return {r[0]: [float(v) for v in r[1:]] for r in rows}


def change(after, before):
    """What a run differs by: errors and times by a tenth, values beyond the error stated by half a
    per cent, the worst of them by half."""
    if after is None: return 'fails'
    said = []
    for part, a in after.items():
        b, words = before[part], []
        if not 0.9 <= a[2] / b[2] <= 1.1: words.append(f'errors x {a[2] / b[2]:.2g}')
        if abs(a[3] - b[3]) > 0.5: words.append(f'beyond stated {b[3]:.1f} -> {a[3]:.1f} %')
        if not 0.67 <= a[5] / b[5] <= 1.5: words.append(f'worst {b[5]:.2g} -> {a[5]:.2g} stated')
        if not 0.9 <= a[6] / b[6] <= 1.1: words.append(f'time x {a[6] / b[6]:.2f}')
        if words: said.append(f'{part}: {", ".join(words)}')
    return '; '.join(said) or '-'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--work', type=pathlib.Path, default=pathlib.Path('/tmp/miebrdf-constants'))
    parser.add_argument('--only', nargs='*', default=[])
    parser.add_argument('--factors', default='0.5,2')
    options = parser.parse_args()
    program, found = make_battery(options.build.resolve(), options.work)
    truth = options.work / 'truth.txt'
    parts = ['averages', 'points', 'tables', 'matrices']
    before = measure(program, truth, parts)
    print('| part | values | median error | 99 % | beyond stated | worst over stated | seconds |\n' + '|---' * 7 + '|')
    for part in parts:
        b = before[part]
        print(f'| {part} | {b[0]:g} | {b[1]:g} | {b[2]:g} | {b[3]:g} % | {b[5]:g} | {b[6]:.2f} |', flush=True)
    factors = options.factors.split(',')
    print(f'\n| constant | value | {" | ".join("x " + f for f in factors)} |\n' + '|---' * (2 + len(factors)) + '|')
    for file, name, value in found:
        if options.only and not any(re.search(o, f'{file}:{name}') for o in options.only): continue
        if not options.only and name in TIME_ALONE: continue
        own = next(p for pattern, p in PARTS if re.search(pattern, file))
        cells = [change(measure(program, truth, own, f'{file}:{name}*{f}'), before) for f in factors]
        print(f'| {file.split(".")[0]}: {name} | {value} | {" | ".join(cells)} |', flush=True)


if __name__ == '__main__':
    main()
