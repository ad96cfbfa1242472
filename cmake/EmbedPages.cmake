# Writes a C++ source with the pages of a folder. The program's help then has the text of the documentation:
#   cmake -DFOLDER=docs/cli -DOUTPUT=pages.cc -P EmbedPages.cmake
file(GLOB files ${FOLDER}/*.md)
list(SORT files)
set(text "// Made by cmake/EmbedPages.cmake; edit the pages instead.\n#include <array>\n\n#include \"moiregauge/cli/help/page.h\"\n\n")
string(APPEND text "namespace moiregauge::internal::cli {\nnamespace {\n\nconst std::array kPages{\n")
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} page)
  string(APPEND text "    Page{\"${name}\", R\"page(${page})page\"},\n")
endforeach()
string(APPEND text "};\n\n}  // namespace\n\nstd::span<const Page> pages() { return kPages; }\n\n}  // namespace moiregauge::internal::cli\n")
file(WRITE ${OUTPUT} "${text}")
