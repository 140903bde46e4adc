#!/bin/sh
# Remakes DejaVuSans-subset.ttf from DejaVu Sans 2.37 (Debian package fonts-dejavu-core).
# Needs pyftsubset from fonttools. The first argument is the path of DejaVuSans.ttf.
set -eu
pyftsubset "$1" --output-file="$(dirname "$0")/DejaVuSans-subset.ttf" \
  --no-hinting --layout-features='' --drop-tables+=kern,GPOS,GSUB,GDEF,FFTM,MATH,gasp --name-IDs=0,1,2,4,5,6 \
  --unicodes=U+20-7E,U+A0-FF,U+131,U+152,U+153,U+160,U+161,U+17D,U+17E,U+391-3A1,U+3A3-3A9,U+3B1-3C9,U+3D1,U+3D5,U+3F5,\
U+2010-2015,U+2018-201A,U+201C-201E,U+2020-2022,U+2026,U+2030,U+2032,U+2033,\
U+2070,U+2071,U+2074-208E,U+2090-209C,U+1D62-1D66,U+2C7C,U+2113,U+2190-2195,U+21D0-21D4,\
U+2202,U+2206-2209,U+220F,U+2211-2213,U+2215,U+2217-221E,U+2220,U+2223,U+2225,U+2227-222B,\
U+223C,U+2243,U+2245,U+2248,U+2260,U+2261,U+2264,U+2265,U+226A,U+226B,U+2282,U+22A5,U+22C5,\
U+25A0,U+25A1,U+25B2,U+25B3,U+25BC,U+25C6,U+25C7,U+25CB,U+25CF,U+2605,U+2713,U+2714,U+2716,U+2717,U+27E8,U+27E9,U+2A7D,U+2A7E
