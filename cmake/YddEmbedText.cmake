# cmake -DOUT=file.inc -DkName=text_file... -P YddEmbedText.cmake kName...
#
# Writes text files as C++ constants: `constexpr std::string_view kName[]`, pieces to be joined.
# Pieces, because compilers limit the length of one literal.
set(out "// Made by cmake/YddEmbedText.cmake.\n")
set(index 0)
while(NOT CMAKE_ARGV${index} STREQUAL "-P")
  math(EXPR index "${index} + 1")
endwhile()
math(EXPR index "${index} + 2") # past the script
while(index LESS CMAKE_ARGC)
  set(name ${CMAKE_ARGV${index}})
  math(EXPR index "${index} + 1")
  file(READ "${${name}}" text)
  string(REGEX REPLACE "(//|/\\*)# sourceMappingURL=[^\n]*" "" text "${text}")  # no such file
  string(LENGTH "${text}" length)
  string(APPEND out "constexpr std::string_view ${name}[] = {\n")
  set(begin 0)
  while(begin LESS length)
    string(SUBSTRING "${text}" ${begin} 16000 piece)
    string(APPEND out "R\"YDDTEXT(${piece})YDDTEXT\",\n")
    math(EXPR begin "${begin} + 16000")
  endwhile()
  string(APPEND out "};\n")
endwhile()
file(WRITE "${OUT}" "${out}")
