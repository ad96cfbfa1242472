# Debian packages moiregauge (the program) and moiregauge-dev (the library). tools/package makes them by these commands:
#   cmake --build build/release --target words && cpack --config build/release/CPackConfig.cmake
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME moiregauge)
set(CPACK_PACKAGE_CONTACT "The moiregauge developers <moiregauge@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "displacement in millimetres from a video of printed gratings")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME moiregauge)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME moiregauge-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "Measures how far printed targets move relative to printed references, with a
standard uncertainty for every number, while the camera itself moves: with a
phone, on a tripod or on a drone. Sampling moire with compensation of the
camera's motion, and a method that compares every pixel with the template of the
grating and solves the lens from the footage. With a simulator of known truth.")
set(CPACK_COMPONENT_DEV_DESCRIPTION
    "Headers and libraries of moiregauge, for C++20 programs. Measures a clip in
three lines, follows a camera frame by frame, simulates recordings.")
# dpkg-shlibdeps finds the linked libraries. Figures also require a font.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libexpected-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "cmake")
include(CPack)
