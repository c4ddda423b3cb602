#!/usr/bin/env bash
# Makes states.json: bodies' displacements (m) and velocities (m/s) at 1 ms and 2 ms in the eight table scenes.
set -euo pipefail
cd "$(dirname "$0")"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
c++ -O2 quad.cpp -lquadmath -o "$folder/quad"
separator='{'
for scene in magnet-0.61g magnet-1.22g magnet-2.75g magnet-17.81g gravity-0.61g gravity-1.22g gravity-2.75g gravity-17.81g; do
  grams=${scene#*-}; grams=${grams%g}
  speed=0.44; [ "$grams" = 17.81 ] && speed=0.20
  magnet=0; [ "${scene%%-*}" = magnet ] && magnet=1
  printf '%s\n"%s": {' "$separator" "$scene"
  "$folder/quad" "$magnet" "${grams}e-3" "$speed" | awk '
    BEGIN { split("u_1ms v_1ms u_2ms v_2ms", name, " ") }
    { gsub(" +$", ""); gsub(" ", ", "); printf "%s\n\"%s\": [%s]", (NR > 1 ? "," : ""), name[NR], $0 }'
  printf '}'
  separator=','
done > states.json
printf '\n}\n' >> states.json
