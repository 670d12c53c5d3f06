# What sherd::sherd links, found the same way by this build and by projects that use the installed package.
#
# OpenVDB's find module lies outside CMake's default path on Debian.
find_path(SHERD_FINDOPENVDB_DIR FindOpenVDB.cmake
  PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB /usr/lib/cmake/OpenVDB /usr/local/lib/cmake/OpenVDB
  REQUIRED)
mark_as_advanced(SHERD_FINDOPENVDB_DIR)
list(APPEND CMAKE_MODULE_PATH ${SHERD_FINDOPENVDB_DIR})
# OpenVDB's module and the packages it asks for talk a lot, and complain of Python parts that nobody uses.
set(SHERD_MESSAGE_LOG_LEVEL ${CMAKE_MESSAGE_LOG_LEVEL})
set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
find_package(OpenVDB 10 REQUIRED COMPONENTS openvdb QUIET)
set(CMAKE_MESSAGE_LOG_LEVEL ${SHERD_MESSAGE_LOG_LEVEL})
find_package(TBB REQUIRED QUIET)
find_package(ZLIB REQUIRED QUIET)
find_package(PNG REQUIRED QUIET)
find_package(OpenSSL REQUIRED COMPONENTS Crypto QUIET)
find_package(draco REQUIRED QUIET)
find_package(embree 3 REQUIRED QUIET)
find_package(Qhull REQUIRED QUIET)
find_package(OpenEXR 3 REQUIRED QUIET)
