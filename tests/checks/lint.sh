#!/usr/bin/env bash
# What lintian says of a package of ours: nothing. They are not uploaded to Debian: they close no bug there, and their
# maintainer has no address. usage: lint.sh DEB
exec lintian --allow-root --suppress-tags initial-upload-closes-no-bugs,bogus-mail-host,bogus-mail-host-in-debian-changelog \
    --fail-on error,warning "$1"
