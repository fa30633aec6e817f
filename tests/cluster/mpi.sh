#!/bin/bash
# A sweep by four processes of mpirun; its table must equal that of one process. Then once more,
# with one of the four killed on its way: mpirun ends the others, and the same command goes on.
#
#   mpi.sh PROGRAM FOLDER
#
# Needs Debian's openmpi-bin; skipped without.
set -eu
program=$1
folder=$2
skip() { echo "skipped: $*"; exit 0; }
command -v mpirun >/dev/null || skip "mpirun is not installed (openmpi-bin)"
launch=(mpirun -n 4 --oversubscribe)
[ "$(id -u)" != 0 ] || launch+=(--allow-run-as-root)
"${launch[@]}" true || skip "mpirun does not start processes here"
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
cat >sweep.toml <<'END'
outputs = ["plane_albedo", "brdf"]
chunk = 2
[scene]
base = "hg:{albedo},{g}"
coat = "hg:0.9,0.5@{depth}"
tolerance = 1e-3
[axes]
albedo = "0.1:0.9:9 linear"
g = [0, 0.3, 0.6]
depth = "0.1:3:12 log"
mu_in = [0.5, 1]
mu_out = [0.3, 0.9]
azimuth_deg = [0, 180]
wavelength_nm = 550
END
table=table.csv
[ "${MIEBRDF_TABLE_KIND:-}" = "" ] || table=table.$MIEBRDF_TABLE_KIND
"$program" sweep sweep.toml -o "one-$table"
"${launch[@]}" "$program" sweep sweep.toml -o "four-$table" 2>&1 | tee log
cmp "one-$table" "four-$table"
[ ! -e "four-$table.parts" ] || { echo "parts are left"; exit 1; }
computed=$(awk '/scenes computed/ { sum += $(NF - 2) } END { print sum }' log)
# The first process may compute again what others have in flight at the end: a chunk of two each.
[ "$computed" -ge 324 ] && [ "$computed" -le 330 ] || { echo "$computed of 324 computed"; exit 1; }
cat >rank.sh <<'END'
#!/bin/bash
# Number 2 dies after its first chunks.
[ "$OMPI_COMM_WORLD_RANK" = 2 ] || exec "$@"
"$@" & pid=$!
for _ in $(seq 200); do
    [ "$(find killed-* -name 'chunk-???????' 2>/dev/null | wc -l)" -lt 8 ] || break
    sleep 0.02
done
kill -9 $pid
wait $pid
END
chmod +x rank.sh
"${launch[@]}" ./rank.sh "$program" sweep sweep.toml -o "killed-$table" >log2 2>&1 || true
"${launch[@]}" "$program" sweep sweep.toml -o "killed-$table"
cmp "one-$table" "killed-$table"
echo "4 processes of $(mpirun --version | head -1): the table equals that of one, killed or not"
