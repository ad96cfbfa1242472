# Dependencies. Their Debian packages are in tools/packages.txt.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tl-expected REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(TBB REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
if(BUILD_TESTING)
  find_package(GTest REQUIRED)
endif()

# libopencv-imgproc-dev has no CMake configuration.
find_path(OPENCV_INCLUDE opencv2/imgproc.hpp PATH_SUFFIXES opencv4 REQUIRED)
find_library(OPENCV_CORE opencv_core REQUIRED)
find_library(OPENCV_IMGPROC opencv_imgproc REQUIRED)
add_library(moiregauge_opencv INTERFACE)
target_include_directories(moiregauge_opencv SYSTEM INTERFACE ${OPENCV_INCLUDE})
target_link_libraries(moiregauge_opencv INTERFACE ${OPENCV_IMGPROC} ${OPENCV_CORE})

pkg_check_modules(LIBAV REQUIRED IMPORTED_TARGET libavformat libavcodec libavutil libswscale)
add_library(moiregauge_libav INTERFACE)
target_link_libraries(moiregauge_libav INTERFACE PkgConfig::LIBAV Threads::Threads rt)

pkg_check_modules(SECCOMP REQUIRED IMPORTED_TARGET libseccomp)

pkg_check_modules(HIGHWAY REQUIRED IMPORTED_TARGET libhwy)

pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)
add_library(moiregauge_cairo INTERFACE)
target_link_libraries(moiregauge_cairo INTERFACE PkgConfig::CAIRO)

pkg_check_modules(PNG REQUIRED IMPORTED_TARGET libpng)
add_library(moiregauge_png INTERFACE)
target_link_libraries(moiregauge_png INTERFACE PkgConfig::PNG)

find_package(ZLIB REQUIRED)

pkg_check_modules(CRYPTO REQUIRED IMPORTED_TARGET libcrypto)
add_library(moiregauge_crypto INTERFACE)
target_link_libraries(moiregauge_crypto INTERFACE PkgConfig::CRYPTO)

pkg_check_modules(IMAGES REQUIRED IMPORTED_TARGET libpng libtiff-4 libjpeg)
find_path(TOML11_INCLUDE toml.hpp PATH_SUFFIXES toml11 REQUIRED)
add_library(moiregauge_images INTERFACE)
target_link_libraries(moiregauge_images INTERFACE PkgConfig::IMAGES)
target_include_directories(moiregauge_images SYSTEM INTERFACE ${TOML11_INCLUDE})

pkg_check_modules(HDF5 REQUIRED IMPORTED_TARGET hdf5-serial)
add_library(moiregauge_hdf5 INTERFACE)
target_link_libraries(moiregauge_hdf5 INTERFACE PkgConfig::HDF5)

# Tables of `export`.
pkg_check_modules(XLSX REQUIRED IMPORTED_TARGET xlsxwriter)
pkg_check_modules(MATIO REQUIRED IMPORTED_TARGET matio)
add_library(moiregauge_tables INTERFACE)
target_link_libraries(moiregauge_tables INTERFACE PkgConfig::XLSX PkgConfig::MATIO)

# Live cameras and outlets. GLib's option -pthread defines a macro, with which the precompiled headers could not be used.
pkg_check_modules(ARAVIS REQUIRED aravis-0.8)
add_library(moiregauge_aravis INTERFACE)
target_include_directories(moiregauge_aravis SYSTEM INTERFACE ${ARAVIS_INCLUDE_DIRS})
target_link_libraries(moiregauge_aravis INTERFACE ${ARAVIS_LINK_LIBRARIES} Threads::Threads)
pkg_check_modules(MOSQUITTO REQUIRED IMPORTED_TARGET libmosquitto)
# Catalogue of `batch`.
pkg_check_modules(SQLITE REQUIRED IMPORTED_TARGET sqlite3)
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib openssl)

# TLS of the server.
pkg_check_modules(OPENSSL REQUIRED IMPORTED_TARGET openssl)
