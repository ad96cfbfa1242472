# Debian packages: moiregauge (the program), libmoiregauge (the library), moiregauge-dev, moiregauge-doc, and with the Python
# module python3-moiregauge. tools/package makes them by these commands:
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
set(CPACK_COMPONENTS_ALL program library dev doc)
if(MOIREGAUGE_PYTHON_MODULE)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME moiregauge)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libmoiregauge${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
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
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
    "Shared library of moiregauge, and the program in which it decodes video.")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "Python module of moiregauge. Measures a clip in two lines, with numpy arrays that
share the memory of the result; follows a camera frame by frame; simulates.")
set(CPACK_COMPONENT_DOC_DESCRIPTION "Pages and notebooks of moiregauge.")
# dpkg-shlibdeps finds the linked libraries, this build's own among them. Figures also require a font.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(own_library "libmoiregauge${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_DOC_PACKAGE_NAME moiregauge-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOC_PACKAGE_SHLIBDEPS OFF)
if(MOIREGAUGE_PYTHON_MODULE)
  math(EXPR next_python "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-moiregauge)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "${own_library}, python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_python}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-matplotlib")
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${own_library}, libexpected-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "cmake")
include(CPack)
