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
for page in README.md:start data/README.md:recordings data/INTEGRATION.md:integration data/CHANGELOG.md:changes \
  data/presets.md:presets data/results/README.md:results data/results/studies.md:studies data/theory.md:theory \
  data/datasets.md:datasets include/rio/README.md:map; do
  cp "${page%%:*}" "$out/source/${page##*:}.md"
done
# links between the documents; those to other files become text
sed -E -i -e 's,\]\((\.\./)*(data/)?results/README\.md,](results.md,g; s,\]\((\.\./)*results/studies\.md,](studies.md,g' \
  -e 's,\]\((\.\./)*include/rio/README\.md,](map.md,g' \
  -e 's,\]\((\.\./)*(data/)?INTEGRATION\.md,](integration.md,g; s,\]\(\.\./\.\./README\.md,](start.md,g' \
  -e 's,\]\((\.\./|data/)?README\.md,](recordings.md,g; s,\]\((\.\./|data/)?(docs/)?([a-z]+\.md),](\3,g' \
  -e 's,\]\((\.\./|data/)(results|pictures)/([a-z0-9]+\.(svg|png)),](\3,g' \
  -e 's,\[([^]]*)\]\((\.\./|config/|awr|src/|include/)[^)]*\),\1,g' "$out"/source/*.md
cp data/results/*.svg data/pictures/*.png "$out/source/"
RIO_PYTHON_SOURCE=$PWD/src/python PYTHONDONTWRITEBYTECODE=1 sphinx-build -q -W --keep-going -j auto -D "version=$version" -D "release=$version" "$out/source" "$out/html"
echo "$out/html/index.html"
