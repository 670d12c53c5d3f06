# Script mode: write OUTPUT, a C++ file with the text of each of FILES, which `sherd::FUNCTION()` returns.
set(text "// Made by cmake/EmbedFiles.cmake.\n#include <span>\n#include <string_view>\n\nnamespace sherd {\nnamespace {\n\n")
string(APPEND text "constexpr std::string_view kTexts[] = {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} body)
  # String literals have a length limit of 64 KiB in the standard; a kernel file stays far below it.
  string(APPEND text "    R\"CLSOURCE(#line 1 \"${name}\"\n${body})CLSOURCE\",\n")
endforeach()
string(APPEND text "};\n\n}  // namespace\n\nstd::span<const std::string_view> ${FUNCTION}();\n")
string(APPEND text "std::span<const std::string_view> ${FUNCTION}() { return kTexts; }\n\n}  // namespace sherd\n")
file(WRITE ${OUTPUT} "${text}")
