#!/usr/bin/env python3
"""Makes the files of a release from the last commit: the same commit gives the same bytes.

    release.py [--url URL] [-o DIR]     DIR is build/release by default

URL is the address where you publish the packages. Without it no packages are made.

    iqfoc-VERSION.tar.gz       the tree of the commit
    iqfoc-arduino-VERSION.zip, iqfoc.iqfoc.VERSION.pack     packages (tools/package.py)
    iqfoc-VERSION.spdx.json    the SBOM: the archive, what the program is linked with, and each tool that ./dev fetches, with its hash
    SHA256SUMS, tag-notes.txt  sums of the above, and notes for `git tag -s` out of CHANGELOG.md

Run by the Python of .cache/python/checks, which has spdx-tools.
"""

import argparse
import datetime
import gzip
import hashlib
import io
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile
import uuid

from urllib.parse import quote

from spdx_tools.spdx.model import (Actor, ActorType, Checksum, ChecksumAlgorithm, CreationInfo, Document, ExternalPackageRef,
                                   ExternalPackageRefCategory, Package, PackagePurpose, Relationship, RelationshipType,
                                   SpdxNoAssertion)
from spdx_tools.spdx.validation.document_validator import validate_full_spdx_document
from spdx_tools.spdx.writer.json import json_writer
from license_expression import get_spdx_licensing

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Debian's libraries that the program is linked with, and their licences; each -dev package of BUILD_PACKAGES must be here.
LINKED = {"libc6": "LGPL-2.1-or-later", "libtomlplusplus": "MIT", "libeigen3": "MPL-2.0", "libkissfft": "BSD-3-Clause",
          "nlohmann-json3": "MIT", "zlib1g": "Zlib"}
# Debian's source packages that the program takes files of.
COMPILED = {"musl": "MIT"}
EMBEDDED = {"uplot": "MIT"}
COPYRIGHT = re.compile(r"^Copyright .*$", re.MULTILINE)


def git(*words, text=True):
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=text).stdout


def archive(prefix):
    """The tree of the last commit as tar; git dates all files by the commit."""
    return git("archive", "--format=tar", f"--prefix={prefix}", "HEAD", text=False)


def gzipped(data):
    """As `gzip -n`: neither a time nor a name in the head."""
    packed = io.BytesIO()
    with gzip.GzipFile(filename="", fileobj=packed, mode="wb", mtime=0) as stream:
        stream.write(data)
    return packed.getvalue()


def linked_packages(setup):
    """The libraries among BUILD_PACKAGES, [(name, licence)]."""
    listed = re.search(r"^BUILD_PACKAGES=\((.*?)\)", setup, re.MULTILINE | re.DOTALL)[1].split()
    names = [name[:-len("-dev")] for name in listed if name.endswith("-dev")]
    unknown = [name for name in names if name not in LINKED]
    if unknown:
        sys.exit(f"release.py knows no licence of {', '.join(unknown)}, which tools/setup.sh has the program linked with")
    return [(name, LINKED[name]) for name in names]


def debian_version(package):
    """The version that this machine has, as the program that is built here is linked with it."""
    done = subprocess.run(["dpkg-query", "-W", "-f=${Version}\n", package], capture_output=True, text=True, check=False)
    version = done.stdout.split("\n")[0]
    return version or sys.exit(f"release.py: {package} is not installed, so that the SBOM has no version of it (./dev build installs it)")


def musl_version(tree):
    """The version of the pinned sources."""
    return re.match(r"# musl ([\d.]+):", (tree / "packages/musl.sha256").read_text(encoding="utf-8"))[1]


def fetched(tree):
    """{(registry, name, version): sha256} of each package that ./dev fetches, by the pins in the tree."""
    found = {}
    for file in sorted((tree / "packages/python").glob("*.txt")):
        for name, version, digests in re.findall(r"^([\w.-]+)==(\S+)((?:\s*\\\s*--hash=sha256:[0-9a-f]{64})+)",
                                                 file.read_text(encoding="utf-8"), re.MULTILINE):
            found[("pypi", name, version)] = re.findall(r"sha256:([0-9a-f]{64})", digests)
    for name, version in re.findall(r"set_up_npm ([\w-]+)@([\d.]+)", (tree / "tools/setup.sh").read_text(encoding="utf-8")):
        sums = (tree / f"packages/{name}.sha256").read_text(encoding="utf-8")
        found[("npm", name, version)] = [line.split()[0] for line in sums.split("\n") if line]
    return found


class Bom:
    """An SPDX document; each package has a stated relationship to iqfoc."""

    def __init__(self, name, version, created, digest):
        self.info = CreationInfo(spdx_version="SPDX-2.3", spdx_id="SPDXRef-DOCUMENT", name=f"{name}-{version}",
                                 data_license="CC0-1.0", document_namespace=uuid.uuid5(uuid.NAMESPACE_OID, f"{name}-{version}-{digest}").urn,
                                 creators=[Actor(ActorType.ORGANIZATION, "The iqfoc authors")], created=created)
        self.packages, self.relations = [], []

    def add(self, ref, relation, name, version, licence, comment=None, digest=None, purl=None, holder=None, purpose=None):
        licence = get_spdx_licensing().parse(licence) if licence else SpdxNoAssertion()
        checksums = [Checksum(ChecksumAlgorithm.SHA256, digest)] if digest else []
        purls = [ExternalPackageRef(ExternalPackageRefCategory.PACKAGE_MANAGER, "purl", purl)] if purl else []
        self.packages.append(Package(
            spdx_id=ref, name=name, download_location=SpdxNoAssertion(), version=version, files_analyzed=False, checksums=checksums,
            license_concluded=licence, license_declared=licence, copyright_text=holder or SpdxNoAssertion(), comment=comment,
            external_references=purls, primary_package_purpose=purpose))
        if relation is None:
            self.relations.append(Relationship("SPDXRef-DOCUMENT", RelationshipType.DESCRIBES, ref))
        elif relation == RelationshipType.DEPENDS_ON:
            self.relations.append(Relationship("SPDXRef-iqfoc", relation, ref))
        else:
            self.relations.append(Relationship(ref, relation, "SPDXRef-iqfoc"))

    def write(self, path):
        document = Document(self.info, packages=self.packages, relationships=self.relations)
        wrong = validate_full_spdx_document(document)
        if wrong:
            sys.exit("the SBOM is no valid SPDX:\n" + "\n".join(message.validation_message for message in wrong))
        json_writer.write_document_to_file(document, str(path), validate=False)


def write_bom(path, tree, version, created, digest):
    bom = Bom("iqfoc", version, created, digest)
    holder = COPYRIGHT.search((tree / "LICENSE").read_text(encoding="utf-8"))[0]
    bom.add("SPDXRef-iqfoc", None, "iqfoc", version, "MIT", digest=digest, holder=holder, purpose=PackagePurpose.ARCHIVE,
            comment="The library (include/, src/) uses nothing of the packages below. The program is linked with those that it depends on; "
                    "the others are tools and tests.")
    setup = (tree / "tools/setup.sh").read_text(encoding="utf-8")
    for name, licence in linked_packages(setup):
        version_ = debian_version(f"{name}-dev")
        bom.add(f"SPDXRef-debian-{name}", RelationshipType.DEPENDS_ON, name, version_, licence,
                purl=f"pkg:deb/debian/{name}-dev@{quote(version_)}", comment="Of the Debian release that builds it, under apt's signatures.")
    for name, licence in COMPILED.items():
        version_ = musl_version(tree)
        bom.add(f"SPDXRef-debian-{name}", RelationshipType.DEPENDS_ON, name, version_, licence, purl=f"pkg:deb/debian/{name}@{version_}?arch=source",
                comment="Its mathematics; packages/musl.sha256 pins each file.")
    for (registry, name, version_), digests in sorted(fetched(tree).items()):
        ref = re.sub(r"[^A-Za-z0-9.-]", "-", f"SPDXRef-{registry}-{name}-{version_}")
        relation = RelationshipType.DEPENDS_ON if name in EMBEDDED else RelationshipType.DEV_DEPENDENCY_OF
        one = digests[0] if len(digests) == 1 else None
        bom.add(ref, relation, name, version_, EMBEDDED.get(name), digest=one, purl=f"pkg:{registry}/{name}@{version_}",
                comment=None if one else "Files by SHA-256: " + ", ".join(digests[:3]) + (" and more" if len(digests) > 3 else ""))
    bom.write(path)


def tag_notes(tree, version, sums):
    """The section of CHANGELOG.md of this version, or what is not yet released, and the sums."""
    changes = (tree / "CHANGELOG.md").read_text(encoding="utf-8")
    for head in (re.escape(version), "Unreleased"):
        section = re.search(rf"^## \[{head}\][^\n]*\n(.*?)(?=^## |\Z)", changes, re.MULTILINE | re.DOTALL)
        if section:
            # git takes lines that begin with # for comments.
            notes = re.sub(r"^#+ (.*)$", r"\1:", section[1].strip(), flags=re.MULTILINE)
            return f"iqfoc {version}\n\n{notes}\n\nSHA-256:\n{sums}"
    sys.exit(f"CHANGELOG.md has no section [{version}] and none [Unreleased]")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--url", help="address where you publish the packages; without it no packages are made")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "build/release")
    options = parser.parse_args()
    out = options.output
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder)
        with tarfile.open(fileobj=io.BytesIO(archive(""))) as files:
            files.extractall(tree)
        version = re.search(r'IQFOC_VERSION_STRING "(.*)"', (tree / "include/iqfoc/version.h").read_text(encoding="utf-8"))[1]
        packed = out / f"iqfoc-{version}.tar.gz"
        packed.write_bytes(gzipped(archive(f"iqfoc-{version}/")))
        day = git("log", "-1", "--format=%cs").strip()
        if options.url:
            subprocess.run([sys.executable, "-B", tree / "tools/package.py", "--url", options.url, "--day", day, "-o", out.absolute()],
                           check=True, stdout=subprocess.DEVNULL)
        created = datetime.datetime.fromtimestamp(int(git("log", "-1", "--format=%ct")), datetime.timezone.utc).replace(tzinfo=None)
        digest = hashlib.sha256(packed.read_bytes()).hexdigest()
        write_bom(out / f"iqfoc-{version}.spdx.json", tree, version, created, digest)
        names = [packed.name, f"iqfoc-{version}.spdx.json"]
        if options.url:
            names += [f"iqfoc-arduino-{version}.zip", f"iqfoc.iqfoc.{version}.pack"]
        sums = "".join(f"{hashlib.sha256((out / name).read_bytes()).hexdigest()}  {name}\n" for name in sorted(names))
        (out / "SHA256SUMS").write_text(sums, encoding="utf-8")
        (out / "tag-notes.txt").write_text(tag_notes(tree, version, sums), encoding="utf-8")
    print(f"{out}: to sign it, git tag -s v{version} -F {out}/tag-notes.txt")


if __name__ == "__main__":
    main()
