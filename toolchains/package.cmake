# What is installed where, and the Debian package: `cmake --build --preset release --target package`.
# tests/checks/package.sh installs, upgrades, removes and purges it.

set(config ${PROJECT_SOURCE_DIR}/config)
set(made ${PROJECT_BINARY_DIR}/package)

# crspf_gzip(FROM NAME): a file as Debian wants its documents. -n: the same bits whenever it is built.
function(crspf_gzip from name)
    add_custom_command(OUTPUT ${made}/${name}.gz
        COMMAND ${CMAKE_COMMAND} -E make_directory ${made}
        COMMAND gzip -9nc ${from} > ${made}/${name}.gz
        DEPENDS ${from} VERBATIM)
    set_property(GLOBAL APPEND PROPERTY crspf_package_files ${made}/${name}.gz)
endfunction()

add_custom_command(OUTPUT ${made}/crspfd.toml.5
    COMMAND ${CMAKE_COMMAND} -E make_directory ${made}
    COMMAND awk -f ${config}/man/reference_to_man.awk ${PROJECT_SOURCE_DIR}/docs/configuration.md > ${made}/crspfd.toml.5
    DEPENDS ${config}/man/reference_to_man.awk ${PROJECT_SOURCE_DIR}/docs/configuration.md VERBATIM)
crspf_gzip(${config}/man/crspf.1 crspf.1)
crspf_gzip(${config}/man/crspfd.8 crspfd.8)
crspf_gzip(${made}/crspfd.toml.5 crspfd.toml.5)
crspf_gzip(${config}/debian/changelog changelog.Debian)
crspf_gzip(${PROJECT_SOURCE_DIR}/CHANGELOG.md changelog)
get_property(files GLOBAL PROPERTY crspf_package_files)
add_custom_target(crspf_package_files ALL DEPENDS ${files})

install(TARGETS crspf crspfd RUNTIME DESTINATION usr/bin)
install(FILES ${config}/crspfd.toml DESTINATION etc/crspf)
install(FILES ${config}/systemd/crspfd.service ${config}/systemd/crspf-stereo.service
    ${config}/systemd/crspf-mqtt.service DESTINATION lib/systemd/system)
install(FILES ${config}/systemd/crspf-mqtt.default DESTINATION etc/default RENAME crspf-mqtt)
install(FILES ${config}/systemd/crspf.sysusers.conf DESTINATION usr/lib/sysusers.d RENAME crspf.conf)
install(FILES ${config}/systemd/crspf.tmpfiles.conf DESTINATION usr/lib/tmpfiles.d RENAME crspf.conf)
install(FILES ${config}/udev/70-crspf.rules DESTINATION lib/udev/rules.d)
install(DIRECTORY ${config}/examples ${config}/dbc DESTINATION usr/share/crspf)
install(FILES ${config}/crspf.dbc DESTINATION usr/share/crspf)
install(FILES ${config}/network/80-can0.network DESTINATION usr/share/crspf/network)
install(FILES ${config}/prometheus/crspf-alerts.yml DESTINATION usr/share/crspf/prometheus)
install(FILES ${config}/completion/crspf.bash DESTINATION usr/share/bash-completion/completions RENAME crspf)
install(FILES ${made}/crspf.1.gz DESTINATION usr/share/man/man1)
install(FILES ${made}/crspfd.toml.5.gz DESTINATION usr/share/man/man5)
install(FILES ${made}/crspfd.8.gz DESTINATION usr/share/man/man8)
install(FILES ${made}/changelog.gz ${made}/changelog.Debian.gz ${config}/debian/copyright
    ${PROJECT_SOURCE_DIR}/docs/arm.md ${PROJECT_SOURCE_DIR}/docs/calibration.md ${PROJECT_SOURCE_DIR}/docs/deployment.md
    ${PROJECT_SOURCE_DIR}/docs/motion-protocol.md ${PROJECT_SOURCE_DIR}/docs/mqtt.md ${PROJECT_SOURCE_DIR}/docs/quickstart.md
    ${PROJECT_SOURCE_DIR}/docs/recordings.md ${PROJECT_SOURCE_DIR}/docs/service.md
    ${PROJECT_SOURCE_DIR}/docs/troubleshooting.md ${PROJECT_SOURCE_DIR}/docs/view.md DESTINATION usr/share/doc/crspf)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_NAME crspf)
set(CPACK_PACKAGE_CONTACT "CRSPF-SLAM maintainers <crspf@localhost.localdomain>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "lidar SLAM that removes the drift of any odometer")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "2D SLAM for robots with a lidar and an odometer: scans are matched to the map
by a self-adaptive particle filter in which the rays that see corners weigh
more.
.
This package holds the service crspfd, the tool crspf that records, replays
and measures runs, and what the system needs to run them in real time.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)
    # dpkg knows which packages have this machine's libraries; which have the other's, sysroot.sh has noted.
    file(WRITE ${made}/dpkg-shlibdeps "#!/bin/sh\nexec dpkg-shlibdeps -L${CMAKE_SYSROOT}/shlibs.local \"$@\"\n")
    file(CHMOD ${made}/dpkg-shlibdeps PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
    file(WRITE ${made}/cpack.cmake "set(SHLIBDEPS_EXECUTABLE ${made}/dpkg-shlibdeps)\n")
    set(CPACK_PROJECT_CONFIG_FILE ${made}/cpack.cmake)
    set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS
        ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} ${CMAKE_SYSROOT}/lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
set(CPACK_DEBIAN_PACKAGE_DEPENDS
    "init-system-helpers (>= 1.54~), systemd | systemd-standalone-sysusers, systemd | systemd-standalone-tmpfiles")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "udev, can-utils, iproute2")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
    ${config}/debian/conffiles ${config}/debian/postinst ${config}/debian/prerm ${config}/debian/postrm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
