# Compile kernel sources, or other files, into a target as strings.
#
#   sherd_embed_kernels(target function file...)
#   sherd_embed_files(target function file...)
#
# Each file goes in unchanged, a kernel behind a #line directive, so that a device's build log names the file and line that an
# editor shows.  `sherd::function()` returns their texts.
function(sherd_embed target function lines)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  set(files)
  foreach(file IN LISTS ARGN)
    get_filename_component(path ${file} ABSOLUTE)
    list(APPEND files ${path})
  endforeach()
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D "FILES=${files}" -D FUNCTION=${function} -D OUTPUT=${output} -D LINES=${lines}
            -P ${PROJECT_SOURCE_DIR}/cmake/EmbedFiles.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/EmbedFiles.cmake
    COMMENT "Embedding ${function}" VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()

function(sherd_embed_kernels target function)
  sherd_embed(${target} ${function} ON ${ARGN})
endfunction()

function(sherd_embed_files target function)
  sherd_embed(${target} ${function} OFF ${ARGN})
endfunction()
