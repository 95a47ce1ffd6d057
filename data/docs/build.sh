#!/usr/bin/env bash
# The site: Doxygen and Sphinx, without a warning, into OUT/html (default build/docs).
#   data/docs/build.sh [OUT]
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-build/docs}
cmake/install_dependencies.sh docs
rm -rf "$out"
mkdir -p "$out"
cp -r data/docs "$out/source"
mkdir -p "$out/source/api"
version=$(sed -n 's/#define RIO_VERSION_[MP][AIO][A-Z]* //p' include/rio/version.hpp | paste -sd.)
{ cat data/docs/Doxyfile; echo "OUTPUT_DIRECTORY = $out/source/api"; echo "PROJECT_NUMBER = $version"; } | doxygen -
for page in data/README.md:recordings data/INTEGRATION.md:integration data/CHANGELOG.md:changes data/presets.md:presets \
  data/results/README.md:results data/theory.md:theory data/datasets.md:datasets include/rio/README.md:map; do
  # links between the documents; those to other files become text
  sed -E -e 's|\]\(results/README\.md|](results.md|; s|\]\(README\.md|](recordings.md|; s|\]\(INTEGRATION\.md|](integration.md|' \
    -e 's,\[([^]]*)\]\((\.\./|config/|awr)[^)]*\),\1,g' "${page%%:*}" >"$out/source/${page##*:}.md"
done
cp data/results/*.svg "$out/source/"
sphinx-build -q -W --keep-going -j auto -D "version=$version" -D "release=$version" "$out/source" "$out/html"
echo "$out/html/index.html"
