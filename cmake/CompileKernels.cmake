# Compile kernels to the processor's own instructions, for the built-in device (src/cl/builtin_device.h).
#
#   sherd_compile_kernels(target function file...)
#
# Each set of instructions becomes one object: kernels/built_ins.h and the files, in one translation unit.  The symbols of
# its kernels begin with `function` and the instructions.  A C++ file lists them with their parameters, whose kinds and
# sizes are the compiler's; `sherd::function()` returns the list, best first, or an empty one in a build without clang.
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

# Sets `result` to the kernels of files as a list of "name(parameters)", as the preprocessor leaves them.
function(sherd_kernels_of result)
  set(unit "#include \"built_ins.h\"\n")
  foreach(path IN LISTS ARGN)
    string(APPEND unit "#include \"${path}\"\n")
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/parameters.cl)
  file(WRITE ${source} "${unit}")
  execute_process(COMMAND ${SHERD_CLANG} -x cl -cl-std=CL1.2 -cl-no-stdinc -I ${PROJECT_SOURCE_DIR}/kernels -E -P ${source}
    OUTPUT_VARIABLE text ERROR_VARIABLE errors RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${SHERD_CLANG} cannot preprocess the kernels:\n${errors}")
  endif()
  string(REGEX REPLACE "[][; \t\r\n]+" " " text " ${text}")  # brackets and semicolons take lists apart
  string(REGEX MATCHALL " (__)?kernel " words "${text}")
  string(REGEX MATCHALL " (__)?kernel void [A-Za-z0-9_]+ ?\\([^()]*\\)" found "${text}")
  list(LENGTH words count)
  list(LENGTH found read)
  if(NOT count EQUAL read)
    message(FATAL_ERROR "Of ${count} kernels ${read} are written as 'kernel void name(parameters)': ${found}")
  endif()
  list(TRANSFORM found REPLACE "^ (__)?kernel void ([A-Za-z0-9_]+) ?" "\\2")
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

# Appends to `unit` the parameters of a kernel, as the compiler has them.  The second declaration is an error where what was
# read above is not what is compiled.
#   kernel  "name(parameters)"
function(sherd_append_parameters unit count prefix kernel)
  string(REGEX MATCH "^([A-Za-z0-9_]+)\\((.*)\\)$" all "${kernel}")
  set(name ${CMAKE_MATCH_1})
  string(STRIP "${CMAKE_MATCH_2}" parameters)
  if(parameters STREQUAL "void")
    set(parameters "")
  endif()
  string(REPLACE "," ";" parameters "${parameters}")
  set(text "void ${kernel};\n")
  if(parameters)
    set(members)
    set(values)
    foreach(parameter IN LISTS parameters)
      string(REGEX MATCH "([A-Za-z_][A-Za-z0-9_]*) *$" found "${parameter}")
      string(APPEND members "${parameter}; ")
      string(APPEND values "  SHERD_PARAMETER(${prefix}_${name}_list, ${CMAKE_MATCH_1}),\n")
    endforeach()
    string(APPEND text "struct ${prefix}_${name}_list { ${members}};\n"
      "__attribute__((visibility(\"hidden\"))) constant struct sherd_parameter ${prefix}_${name}_parameters[] = {\n${values}};\n")
  endif()
  list(LENGTH parameters number)
  set(${unit} "${${unit}}${text}" PARENT_SCOPE)
  set(${count} ${number} PARENT_SCOPE)
endfunction()

function(sherd_compile_kernels target function)
  set(files)
  set(kernels)
  foreach(file IN LISTS ARGN)
    get_filename_component(path ${file} ABSOLUTE)
    list(APPEND files ${path})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})  # for the kernels
  endforeach()
  if(sherd_instructions)
    sherd_kernels_of(kernels ${files})
  endif()

  set(declarations)
  set(tables)
  set(sets)
  foreach(instructions IN LISTS sherd_instructions)
    string(REPLACE - _ prefix "${function}_${instructions}")
    set(unit "// Made by cmake/CompileKernels.cmake.\n")
    string(APPEND tables "constexpr NativeKernels::Entry k_${prefix}[] = {\n")
    set(lists)
    foreach(kernel IN LISTS kernels)
      string(REGEX MATCH "^[A-Za-z0-9_]+" name "${kernel}")
      sherd_append_parameters(lists count ${prefix} "${kernel}")
      string(APPEND unit "#define ${name} ${prefix}_${name}\n")
      string(APPEND declarations "void ${prefix}_${name}();\n")
      set(parameters "{}")
      if(count GREATER 0)
        set(parameters ${prefix}_${name}_parameters)
        string(APPEND declarations
          "__attribute__((visibility(\"hidden\"))) extern const sherd::ArgumentType ${parameters}[${count}];\n")
      endif()
      string(APPEND tables "    {\"${name}\", ${prefix}_${name}, ${parameters}},\n")
    endforeach()
    string(APPEND tables "};\n")
    string(APPEND sets "    {\"${instructions}\", \"${sherd_kernel_compiler}\", k_${prefix}},\n")
    string(APPEND unit "#include \"built_ins.h\"\n")
    foreach(path IN LISTS files)
      string(APPEND unit "#include \"${path}\"\n")
    endforeach()
    string(APPEND unit "${lists}")
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
