#!/usr/bin/env bash
# tests/acceptance/package.sh [--quick]: the Debian package, one line each: NAME VALUE BOUND ok|short; exit 0 only if none is
# short. Builds it by `cpack -G DEB`, installs it on a bare Debian 12 root (debootstrap --variant=minbase) and runs it there:
# version, starters, a calibration, completions and manual. --quick: the package's contents alone. Otherwise needs root,
# debootstrap and a Debian mirror; the root is build/acceptance/bookworm, kept for the next time as it was before the install.
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"

begun=$SECONDS
(cd build/release && cpack -G DEB -B "$out/package" >"$out/cpack.log") || tail -3 "$out/cpack.log" >&2
package=$(find "$out/package" -maxdepth 1 -name 'grainlaw*.deb' -printf '%T@ %p\n' 2>/dev/null | sort -n | tail -1 | cut -d' ' -f2-)
figure package.seconds $((SECONDS - begun)) stated
figure package.megabytes "$(stat -c %s "$package" | awk '{ printf "%.2f", $1 / 1e6 }')" "<=20"
dpkg-deb --contents "$package" >"$out/contents.txt"
expected=(bin/grainlaw share/bash-completion/completions/grainlaw share/zsh/site-functions/_grainlaw
  share/fish/vendor_completions.d/grainlaw.fish share/man/man1/grainlaw.1 share/man/man1/grainlaw-calibrate.1
  share/grainlaw/schemas/spec.schema.json share/doc/grainlaw/docs/formats.md)
missing=0
for file in "${expected[@]}"; do
  grep -q " ./usr/$file$" "$out/contents.txt" || { echo "package: no $file" >&2; missing=$((missing + 1)); }
done
figure package.missing_files "$missing" "<=0"
# what it depends on is what its programs link
figure package.depends "$(dpkg-deb -f "$package" Depends | tr ',' '\n' | grep -c .)" ">=3"
if [[ $quick == yes ]]; then finish_figures; exit; fi

root=$out/bookworm
if ((EUID != 0)) || ! command -v debootstrap >/dev/null; then
  figure package.bare_root missing stated
  finish_figures
  exit
fi
begun=$SECONDS
if [[ ! -s $root.tar ]]; then
  rm -rf "$root"
  debootstrap --variant=minbase bookworm "$root" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$out/debootstrap.log"
  # the machine's own way to the mirror
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  find /etc/apt/apt.conf.d -iname '*proxy*' -exec cp {} "$root/etc/apt/apt.conf.d/" \;
  tar -C "$root" -cf "$root.part" . && mv "$root.part" "$root.tar"
fi
rm -rf "$root"
mkdir "$root"
tar -C "$root" -xf "$root.tar"
figure package.root_seconds $((SECONDS - begun)) stated
figure package.root_packages_before "$(chroot "$root" dpkg-query -f '.\n' -W | wc -l)" stated

mkdir "$root/work"
cp "$package" "$root/work/grainlaw.deb"
mount -t proc proc "$root/proc"
trap 'umount "$root/proc"' EXIT
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -c "cd /work; $1"; }
code_of() { local code=0; inside "$1" >"$out/inside.txt" 2>"$out/inside.log" || code=$?; ((code == 0)) || tail -3 "$out/inside.log" >&2; echo "$code"; }
begun=$SECONDS
figure package.install_exit "$(code_of 'apt-get -q update && apt-get -q -y install --no-install-recommends ./grainlaw.deb')" "<=0"
figure package.install_seconds $((SECONDS - begun)) stated
figure package.root_packages_after "$(chroot "$root" dpkg-query -f '.\n' -W | wc -l)" stated
figure package.version_exit "$(code_of 'grainlaw --version')" "<=0"
figure package.init_exit "$(code_of 'for kind in spec test path dataset; do grainlaw init $kind; done; grep -q file:///usr/share/grainlaw/schemas spec.json')" "<=0"
figure package.check_exit "$(code_of 'grainlaw check spec.json test.json path.json dataset')" "<=0"
begun=$SECONDS
figure package.calibrate_exit "$(code_of 'grainlaw calibrate spec.json -o out --quiet && test -s out/parameters.json')" "<=0"
figure package.calibrate_seconds $((SECONDS - begun)) stated
figure package.predict_exit "$(code_of 'grainlaw predict out/parameters.json path.json -o out/predictions/mine --quiet')" "<=0"
figure package.report_exit "$(code_of 'grainlaw report out -o out/report.html')" "<=0"
figure package.remove_exit "$(code_of 'apt-get -q -y remove grainlaw && ! command -v grainlaw && ! ls -d /usr/share/grainlaw')" "<=0"
finish_figures
