# Writes a C++ source with the bytes of one file:
#   cmake -DFILE=page.html -DHEADER=moiregauge/report/report_page.h -DFUNCTION=report_template -DOUTPUT=page.cc -P EmbedFile.cmake
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(................................................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUTPUT} "// Made by cmake/EmbedFile.cmake; edit the file instead.
#include \"${HEADER}\"

namespace moiregauge::internal {
namespace {

constexpr unsigned char kBytes[] = {
${bytes}
};

}  // namespace

std::string_view ${FUNCTION}() { return {reinterpret_cast<const char*>(kBytes), sizeof kBytes}; }

}  // namespace moiregauge::internal
")
