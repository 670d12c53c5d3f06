# Everything Sherd builds on: Debian 12 packages, nothing downloaded.
include(cmake/SherdDependencies.cmake)
find_package(CLI11 REQUIRED QUIET)
find_package(assimp REQUIRED QUIET)  # of sherd-assimp alone
find_package(nlohmann_json REQUIRED QUIET)
if(SHERD_GPL OR SHERD_TESTS)  # the tests compare with its exact kernel
  set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE ON)
  find_package(CGAL REQUIRED QUIET)
endif()

# OpenCL 1.2 by its C++ bindings, errors as exceptions.  Only headers: src/cl/open_cl_loader.cpp opens the library.
add_library(sherd_opencl INTERFACE)
if(SHERD_OPENCL)
  find_path(SHERD_OPENCL_HEADERS CL/opencl.hpp REQUIRED)
  mark_as_advanced(SHERD_OPENCL_HEADERS)
  target_include_directories(sherd_opencl SYSTEM INTERFACE ${SHERD_OPENCL_HEADERS})
  target_compile_definitions(sherd_opencl INTERFACE
    CL_HPP_TARGET_OPENCL_VERSION=120 CL_HPP_MINIMUM_OPENCL_VERSION=120 CL_HPP_ENABLE_EXCEPTIONS
    CL_TARGET_OPENCL_VERSION=120)
endif()

# HDF5.  Only the header: src/formats/arrays/hdf5_library.cpp opens the library.
add_library(sherd_hdf5 INTERFACE)
if(SHERD_HDF5)
  find_path(SHERD_HDF5_HEADERS hdf5.h PATH_SUFFIXES hdf5/serial REQUIRED)
  mark_as_advanced(SHERD_HDF5_HEADERS)
  target_include_directories(sherd_hdf5 SYSTEM INTERFACE ${SHERD_HDF5_HEADERS})
endif()
