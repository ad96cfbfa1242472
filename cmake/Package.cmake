# `cmake --build build/release --target words && cpack --config build/release/CPackConfig.cmake` makes
# moiregauge_<version>_<architecture>.deb (tools/package does both).
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
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "Measures how far printed targets move relative to printed references, with a
standard uncertainty for every number, while the camera itself moves: from a
telephone, a tripod or a drone. Sampling moire with compensation of the camera's
motion, and a method that compares every pixel with the learned print and solves
the lens from the footage. With a simulator whose truth is known, and the C++
library behind the program.")
# What the program is linked with is found by dpkg-shlibdeps; the figures need letters.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core")
# Whoever links the library needs what it was built with.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "cmake, pkg-config, libeigen3-dev, libexpected-dev, libceres-dev, libopencv-imgproc-dev, libhwy-dev, libtbb-dev, libfmt-dev, nlohmann-json3-dev, libtoml11-dev, libavformat-dev, libavcodec-dev, libavutil-dev, libswscale-dev, libtiff-dev, libpng-dev, libjpeg62-turbo-dev, libssl-dev, libseccomp-dev, libcairo2-dev, libhdf5-dev, zlib1g-dev")
include(CPack)
