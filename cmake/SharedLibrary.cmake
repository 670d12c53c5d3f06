# What a wheel holds beside the Python module: the objects of this build linked as a shared library, and the program that uses
# it.  Nothing is compiled again.  python/CMakeLists.txt finds them by sherdShared.cmake in the build folder, or builds all of this.
set(shared_folder ${PROJECT_BINARY_DIR}/shared)
file(CONFIGURE OUTPUT ${shared_folder}/library.cpp CONTENT "// CMake links no library without a source.\n")
add_library(sherd_shared SHARED ${shared_folder}/library.cpp)
target_link_libraries(sherd_shared PUBLIC OpenVDB::openvdb PRIVATE $<LINK_LIBRARY:WHOLE_ARCHIVE,sherd>)
target_compile_features(sherd_shared PUBLIC cxx_std_20)
# Calls within the library do not go through its table of symbols; what is not used is left out; the debugger's part is not linked.
target_link_options(sherd_shared PRIVATE -Wl,-Bsymbolic-functions -Wl,--gc-sections)

# The program without packages under the GPL, whatever SHERD_GPL says of the other one.
add_executable(sherd_shared_cli $<TARGET_OBJECTS:sherd_cli> src/cgal/no_cgal_checks.cpp)
target_include_directories(sherd_shared_cli PRIVATE include src)
target_link_libraries(sherd_shared_cli PRIVATE sherd_shared TBB::tbb sherd_flags)
set_target_properties(sherd_shared PROPERTIES OUTPUT_NAME sherd)
set_target_properties(sherd_shared_cli PROPERTIES OUTPUT_NAME sherd BUILD_RPATH_USE_ORIGIN ON
  BUILD_RPATH "$ORIGIN/..")  # where a wheel has the library
set_target_properties(sherd_shared sherd_shared_cli PROPERTIES
  LIBRARY_OUTPUT_DIRECTORY ${shared_folder} RUNTIME_OUTPUT_DIRECTORY ${shared_folder})
add_custom_target(sherd_wheel_parts DEPENDS sherd_shared sherd_shared_cli sherd_assimp)
export(TARGETS sherd_shared sherd_shared_cli sherd_assimp NAMESPACE sherd:: FILE ${PROJECT_BINARY_DIR}/sherdShared.cmake)
