# Script mode: write OUTPUT, a C++ file with the text of each of FILES.
set(text "// Made from kernels/ by cmake/EmbedFiles.cmake.\n#include \"cl/kernel_sources.h\"\n\n")
string(APPEND text "namespace sherd::kernels {\n\nconst std::string_view kSources[] = {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} body)
  # String literals have a length limit of 64 KiB in the standard; a kernel file stays far below it.
  string(APPEND text "    R\"CLSOURCE(#line 1 \"${name}\"\n${body})CLSOURCE\",\n")
endforeach()
string(APPEND text "};\n\nstd::span<const std::string_view> sources() { return kSources; }\n\n}  // namespace sherd::kernels\n")
file(WRITE ${OUTPUT} "${text}")
