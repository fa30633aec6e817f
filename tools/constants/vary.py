#!/usr/bin/env python3
"""What each constant of mie and rte does: errors and time with half and twice its value.

    tools/constants/vary.py mie|rte BUILD [--work FOLDER] [--only NAME...] [--factors 0.5,2]

Without --only, constants that change time alone are left out.

BUILD is a configured and built tree (`build/native`), whose flags and libraries are taken. Copies of
the files with constants are compiled in which these read an environment variable, and linked before
the libraries; a battery (beside this script) measures the parts that a constant may matter to:
ensemble_battery averages over sizes, transfer_battery radiative transfer. Printed are tables in
Markdown: the errors as they are (in tolerances; how many exceed the error stated), and what changes
with each constant. Some minutes for the copy, half a minute for each constant.
"""
import argparse, json, os, pathlib, re, shlex, subprocess, sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DECLARATION = re.compile(
    r'^(?P<indent> *)(?P<scope>static |inline )?constexpr (?P<type>double|float|int|std::size_t|Eigen::Index) '
    r'(?P<list>[a-z]\w+ =[^;{}]*);', re.M)
# Sizes of arrays and of registers, which change no more than rounding and time, and the constants
# of formats.
FIXED = {'kAnglesPerTile', 'kTileStep', 'kRegisters', 'kCount', 'kVectors', 'kPanelNodes', 'kNodes',
         'kTileRows', 'kGroup', 'kDiagonalsPerJob', 'kInterpolating', 'kPieceNodes', 'kPowers',
         'kRowsPerRate', 'kPiece', 'kEnds', 'kPi', 'kInfinity', 'kDegree', 'kBytesPerWave', 'kJobs',
         'kBothSamples', 'kPieceWaves', 'kMostSizesPerBlock', 'kMostRays', 'kMostRates',
         'kRegisterSize', 'kNumbers', 'kIncidences', 'kTogether', 'kNeighbours', 'kDip', 'kFewestNodes', 'kMostNodes',
         'kCut', 'kLargest', 'kHalf', 'half', 'whole', 'unknown', 'never', 'piece', 'columns', 'part', 'count', 'N',
         'last', 'end', 'kLeastIndex', 'kLargestIndex', 'kLeastRoughIndex', 'kLeastIndexStep', 'shares_of_two',
         'kSeriesLanes', 'kStreams', 'kWideShare', 'kNarrowShare', 'kDoublings', 'kPolynomials'}
# Memory, pieces for threads, limits of patience, rounding: they change time or nothing.
TIME_ALONE = {'kMostKept', 'kMostChunksOfSample', 'kLeastChunkOfSample', 'kMostColumns', 'kMostOfFunctions',
              'kTilesPerJob', 'kTilesWorthACopy', 'kMostChunks', 'kLeastChunk', 'kChunkMemory', 'kPartMemory',
              'kAnglesPerJob', 'kNodesAtOnce', 'kProductsPerSecond', 'kMostProducts', 'kMostPerPiece',
              'kMostTermsAtAngles', 'kJustAllowed', 'kRounding', 'kLeastLoss', 'kRoundedToNothing', 'kNegligible',
              'kNodeLimit', 'kLeastSingleTolerance', 'kLeastTableTolerance', 'kMomentsToJudge',
              'kMostKeptPairs', 'kMostAtOnce', 'kLargestCoefficientWise', 'most', 'small', 'rounding', 'kStraight',
              'kDefaultTolerance', 'kPlateau', 'kRamp', 'kFinest', 'kLastLevel', 'kLeastTolerance', 'kBackward'}
# Spheroids, derivatives and whole laws of sizes are not in the battery.
NOT_MEASURED = ('spheroid_average.cpp', 'average_difference.cpp', 'mean_cross_section.cpp', 'size_laws.cpp')
ROOMS = {'mie': ('ensemble', 'sizes'),
         'rte': ('boundary', 'first_order', 'fourier', 'grid', 'half_space', 'layer', 'math/tolerance_budget.h',
                 'phase', 'stack', 'surface')}
LIBRARIES = ('mie/libmiebrdf_mie.a', 'rte/libmiebrdf_rte.a', 'rte/math/libmiebrdf_math.a')
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
SETS = ('', 'rare-')
PARTS = {'mie': [(r'matrix_average|matrix_series', ['matrices']),
                 (r'ray_average', ['averages', 'points', 'tables']),
                 (r'exact_extinction|size_passes|moment_transform|ray_moments|size_nodes', ['averages', 'matrices']),
                 (r'ensemble\.cpp|particle_ensemble', ['averages', 'tables', 'matrices']),
                 (r'', ['points', 'tables'])],
         'rte': [(r'facet|rough_|panel_functions', ['rough']),
                 (r'refraction_grid', ['smooth', 'rough']),
                 (r'glory', ['spheres', 'glories']),
                 (r'hidden_layers', ['media', 'coats', 'smooth', 'hidden']),
                 (r'', ['media', 'coats', 'smooth', 'spheres', 'glories', 'values'])]}


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


def compile_flags(build, area):
    for entry in json.load(open(build / 'compile_commands.json')):
        words = shlex.split(entry['command'])
        if any(w.endswith(('cxx.o', 'cpp.o')) and f'miebrdf_{area}.dir' in w for w in words):
            kept = [w for w in words if w.startswith(('-D', '-O', '-m', '-std', '-f')) and w != '-fpch-preprocess']
            for flag in ('-I', '-isystem'):
                for i, w in enumerate(words):
                    if w == flag: kept += [flag, words[i + 1]]
                    elif w.startswith(flag) and w != flag and flag == '-I': kept.append(w)
            return kept
    sys.exit(f'no compile command of {area}/ in {build}')


def make_battery(area, build, work, targets):
    """The battery, and the constants as (file, name, value). The targets are linked with them, too."""
    found, changed = [], {}
    for path in sorted((ROOT / area).glob('**/*')):
        relative = path.relative_to(ROOT)
        if path.suffix not in ('.cpp', '.h') or relative.name in NOT_MEASURED: continue
        if not any(str(relative).startswith(f'{area}/{room}') for room in ROOMS[area]): continue
        text = changeable(path.read_text(), relative.name, found)
        if text != path.read_text(): changed[relative] = text
    headers = [str(r) for r in changed if r.suffix == '.h']
    for path in sorted((ROOT / area).glob('**/*.cpp')):  # those that include a changed header
        relative, text = path.relative_to(ROOT), path.read_text()
        includes = any(f'"{h}"' in text for h in headers) and relative.parts[1] in ROOMS[area]
        if relative not in changed and includes: changed[relative] = text
    work.mkdir(parents=True, exist_ok=True)
    for relative, text in {pathlib.Path('vary.h'): VARY, **changed}.items():
        target = work / relative
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text() != text: target.write_text(text)
    name = {'mie': 'ensemble_battery', 'rte': 'transfer_battery'}[area]
    flags = ['-I' + str(work), '-I' + str(ROOT), '-I' + str(ROOT / 'mie/include')] + compile_flags(build, area)
    newest = max(f.stat().st_mtime for f in work.glob('**/*.h'))
    # Up to six files of a room at a time, as the libraries are compiled.
    units = {name: [HERE / (name + '.cpp')]}
    for room in sorted({r.parts[1] for r in changed}):
        own = [work / r for r in changed if r.suffix == '.cpp' and r.parts[1] == room]
        alone = [f for f in own if room == 'sizes' or f.stem == 'far_rays']  # share names
        own = [f for f in own if f not in alone]
        units |= {f.stem: [f] for f in alone}
        units |= {f'{room}_{i}': own[i:i + 6] for i in range(0, len(own), 6)}
    objects = []
    for unit, files in units.items():
        source = work / (unit + '_unit.cpp')
        objects.append(source.with_suffix('.o'))
        if objects[-1].exists() and objects[-1].stat().st_mtime > max(newest, *(f.stat().st_mtime for f in files)):
            continue
        source.write_text(''.join(f'#include "{f}"\n' for f in files))
        subprocess.run(['c++', *flags, '-w', '-c', str(source), '-o', str(objects[-1])], check=True)
    newest = max(f.stat().st_mtime for f in [*objects, *(build / l for l in LIBRARIES)])
    is_made = (work / name).exists() and (work / name).stat().st_mtime > newest
    # What stands in the libraries too is taken from the objects, which come first.
    if not is_made:
        subprocess.run(['c++', '-Wl,--allow-multiple-definition', *map(str, objects),
                        *(str(build / l) for l in LIBRARIES), '-lfmt', '-ltbb', '-o', str(work / name)], check=True)
    for target in targets:
        lines = subprocess.run(['ninja', '-C', str(build), '-t', 'commands', target], check=True, text=True,
                               capture_output=True).stdout.splitlines()
        words = shlex.split(re.sub(r'^: && | && .*', '', lines[-1]))
        words[words.index('-o') + 1] = str((work / target).resolve())
        words[1:1] = ['-Wl,--allow-multiple-definition', *(str(o.resolve()) for o in objects[1:])]
        subprocess.run(words, cwd=build, check=True)
    return work / name, found


def measure(program, truth, parts, vary='', timeout=300):
    try:
        out = subprocess.run([str(program), str(truth), *parts], env={**os.environ, 'VARY': vary},
                             capture_output=True, text=True, timeout=timeout)
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
    parser.add_argument('area', choices=('mie', 'rte'))
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--work', type=pathlib.Path, default=pathlib.Path('/tmp/miebrdf-constants'))
    parser.add_argument('--only', nargs='*', default=[])
    parser.add_argument('--factors', default='0.5,2')
    parser.add_argument('--parts', nargs='*', default=[], help='of the battery; those that a file concerns')
    parser.add_argument('--link', nargs='*', default=[], help='targets (test_rte) made in WORK/AREA, which read VARY=file:name*factor')
    options = parser.parse_args()
    work = options.work / options.area
    program, found = make_battery(options.area, options.build.resolve(), work, options.link)
    truth = work / 'truth.txt'
    # No names: all parts. The first time this makes the sums, too.
    before = measure(program, truth, options.parts, timeout=None)
    parts = list(before)
    print('| part | values | median error | 99 % | beyond stated | worst over stated | seconds |\n' + '|---' * 7 + '|')
    for part in parts:
        b = before[part]
        print(f'| {part} | {b[0]:g} | {b[1]:g} | {b[2]:g} | {b[3]:g} % | {b[5]:g} | {b[6]:.2f} |', flush=True)
    factors = options.factors.split(',')
    print(f'\n| constant | value | {" | ".join("x " + f for f in factors)} |\n' + '|---' * (2 + len(factors)) + '|')
    for file, name, value in found:
        if options.only and not any(re.search(o, f'{file}:{name}') for o in options.only): continue
        if not options.only and name in TIME_ALONE: continue
        own = next(p for pattern, p in PARTS[options.area] if re.search(pattern, file))
        own = options.parts or [s + p for s in SETS for p in own if s + p in before]
        cells = [change(measure(program, truth, own, f'{file}:{name}*{f}'), before) for f in factors]
        print(f'| {file.split(".")[0]}: {name} | {value} | {" | ".join(cells)} |', flush=True)


if __name__ == '__main__':
    main()
