# Compile kernel sources into a target as strings.
#
#   sherd_embed_kernels(target file...)
#
# Each file goes in unchanged, behind a #line directive, so that a device's build log names the file and line that an
# editor shows.  src/cl/kernel_sources.h finds them.
function(sherd_embed_kernels target)
  set(output ${PROJECT_BINARY_DIR}/kernel_sources.cpp)
  set(files)
  foreach(file IN LISTS ARGN)
    list(APPEND files ${PROJECT_SOURCE_DIR}/${file})
  endforeach()
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D "FILES=${files}" -D OUTPUT=${output} -P ${PROJECT_SOURCE_DIR}/cmake/EmbedFiles.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/EmbedFiles.cmake
    COMMENT "Embedding kernels" VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
