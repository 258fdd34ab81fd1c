# cmake -DOUTPUT=x.cpp -DNAMESPACE=a::b "-DTEXTS=name=file|name=file" -P EmbedText.cmake
#
# Writes a source file that defines, for each text, `const std::string_view name` with the bytes of
# the file, and `const std::string_view name_sha256` with their checksum (64 hex digits).
set(delimiter "GRAINFIELD_TEXT")
file(WRITE ${OUTPUT}.tmp "#include <string_view>\n\nnamespace ${NAMESPACE} {\n")
string(REPLACE "|" ";" texts "${TEXTS}")
foreach(pair IN LISTS texts)
  string(REGEX MATCH "^([^=]+)=(.*)$" matched "${pair}")
  set(name ${CMAKE_MATCH_1})
  set(source ${CMAKE_MATCH_2})
  file(SHA256 ${source} checksum)
  file(READ ${source} content)
  string(FIND "${content}" "${delimiter}" clash)
  if(NOT clash EQUAL -1)
    message(FATAL_ERROR "EmbedText: '${source}' contains ${delimiter}")
  endif()
  file(APPEND ${OUTPUT}.tmp
    "extern const std::string_view ${name}, ${name}_sha256;\n"
    "const std::string_view ${name}_sha256 = \"${checksum}\";\n"
    "const std::string_view ${name} = R\"${delimiter}(")
  file(APPEND ${OUTPUT}.tmp "${content}")
  file(APPEND ${OUTPUT}.tmp ")${delimiter}\";\n")
endforeach()
file(APPEND ${OUTPUT}.tmp "}  // namespace ${NAMESPACE}\n")
file(RENAME ${OUTPUT}.tmp ${OUTPUT})
