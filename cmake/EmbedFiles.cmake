# Script mode: write OUTPUT, a C++ file with the text of each of FILES, which `sherd::FUNCTION()` returns.  LINES puts a #line
# directive before each.
set(text "// Made by cmake/EmbedFiles.cmake.\n#include <span>\n#include <string_view>\n\nnamespace sherd {\nnamespace {\n\n")
string(APPEND text "constexpr std::string_view kTexts[] = {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} body)
  # String literals have a length limit of 64 KiB in the standard; a kernel file stays far below it.
  set(line "")
  if(LINES)
    set(line "#line 1 \"${name}\"\n")
  endif()
  string(APPEND text "    R\"CLSOURCE(${line}${body})CLSOURCE\",\n")
endforeach()
string(APPEND text "};\n\n}  // namespace\n\nstd::span<const std::string_view> ${FUNCTION}();\n")
string(APPEND text "std::span<const std::string_view> ${FUNCTION}() { return kTexts; }\n\n}  // namespace sherd\n")
file(WRITE ${OUTPUT} "${text}")
