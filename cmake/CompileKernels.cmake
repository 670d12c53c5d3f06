# Compile kernels to the processor's own instructions, for the built-in device (src/cl/builtin_device.h).
#
#   sherd_compile_kernels(target function file...)
#
# Each set of instructions becomes one object: kernels/built_ins.h and the files, in one translation unit.  The symbols of
# its kernels begin with `function` and the instructions.  A C++ file lists them; `sherd::function()` returns the list,
# best first, or an empty one in a build without clang.
find_program(SHERD_CLANG NAMES clang clang-19 clang-18 clang-17 clang-16 clang-15 clang-14
  DOC "Compiles the kernels of the built-in device; without it there is none")

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(sherd_instructions x86-64-v4 x86-64-v3 x86-64-v2)
else()  # not tested on others (docs/decisions/0001-the-kernel-is-the-implementation.md)
  set(sherd_instructions)
endif()

set(sherd_kernel_compiler)
if(SHERD_CLANG)
  execute_process(COMMAND ${SHERD_CLANG} --version OUTPUT_VARIABLE version)
  string(REGEX MATCH "clang version ([0-9.]+)" found "${version}")
  set(sherd_kernel_compiler "clang ${CMAKE_MATCH_1}")
endif()
if(NOT SHERD_CLANG OR CMAKE_MATCH_1 VERSION_LESS 14)  # which has __builtin_elementwise_min
  message(STATUS "Sherd: no clang 14 or later, so the built-in device is left out")
  set(sherd_instructions)
endif()
if(NOT sherd_instructions AND NOT SHERD_OPENCL)
  message(FATAL_ERROR "There is no built-in device for this processor or without clang, so SHERD_OPENCL is needed")
endif()

function(sherd_compile_kernels target function)
  set(files)
  set(names)
  foreach(file IN LISTS ARGN)
    get_filename_component(path ${file} ABSOLUTE)
    list(APPEND files ${path})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})  # for the names
    file(STRINGS ${path} lines REGEX "^kernel void ")
    foreach(line IN LISTS lines)
      string(REGEX MATCH "^kernel void ([a-z0-9_]+)" found "${line}")
      list(APPEND names ${CMAKE_MATCH_1})
    endforeach()
  endforeach()

  set(declarations)
  set(tables)
  set(sets)
  foreach(instructions IN LISTS sherd_instructions)
    string(REPLACE - _ prefix "${function}_${instructions}")
    set(unit "// Made by cmake/CompileKernels.cmake.\n")
    string(APPEND tables "constexpr NativeKernels::Entry k_${prefix}[] = {\n")
    foreach(name IN LISTS names)
      string(APPEND unit "#define ${name} ${prefix}_${name}\n")
      string(APPEND declarations "void ${prefix}_${name}();\n")
      string(APPEND tables "    {\"${name}\", ${prefix}_${name}},\n")
    endforeach()
    string(APPEND tables "};\n")
    string(APPEND sets "    {\"${instructions}\", \"${sherd_kernel_compiler}\", k_${prefix}},\n")
    string(APPEND unit "#include \"built_ins.h\"\n")
    foreach(path IN LISTS files)
      string(APPEND unit "#include \"${path}\"\n")
    endforeach()
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${prefix}.cl)
    file(CONFIGURE OUTPUT ${source} CONTENT "${unit}" @ONLY)
    set(object ${CMAKE_CURRENT_BINARY_DIR}/${prefix}.o)
    set(sanitize)
    if(SHERD_SANITIZE)
      set(sanitize -fsanitize=${SHERD_SANITIZE} -fno-sanitize-recover=undefined -fno-omit-frame-pointer -g1)
    endif()
    add_custom_command(OUTPUT ${object}
      COMMAND ${SHERD_CLANG} -x cl -cl-std=CL1.2 -cl-no-stdinc -Dkernel= -D__kernel= -I ${PROJECT_SOURCE_DIR}/kernels
              -O3 -march=${instructions} -fPIC -Wall -Wno-psabi -Wno-unused-function ${sanitize}
              -MD -MF ${object}.d -c ${source} -o ${object}
      DEPENDS ${source} DEPFILE ${object}.d
      COMMENT "Compiling kernels for ${instructions}" VERBATIM)
    set_source_files_properties(${object} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
    target_sources(${target} PRIVATE ${object})
  endforeach()

  if(sets)
    set(list "constexpr NativeKernels kSets[] = {\n${sets}};\n")
    set(result "kSets")
  else()
    set(list)
    set(result "{}")
  endif()
  set(listing ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  file(CONFIGURE OUTPUT ${listing} @ONLY CONTENT "// Made by cmake/CompileKernels.cmake.
#include \"cl/builtin_device.h\"

extern \"C\" {
${declarations}}

namespace sherd {
namespace {

${tables}
${list}
}  // namespace

std::span<const NativeKernels> ${function}() { return ${result}; }

}  // namespace sherd
")
  target_sources(${target} PRIVATE ${listing})
endfunction()
