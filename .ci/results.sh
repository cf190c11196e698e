# shellcheck shell=sh
# Sourced by ./test: reads CTest's JUnit files, and tells what they say.

# attribute NAME FILE: the value of an attribute of the first testsuite.
attribute() { sed -n "s/.*[[:space:]]$1=\"\([0-9]*\)\".*/\1/p;T;q" "$2"; }

# Functions for awk: a test's name, and the text of a line of XML.
xml='function test_name(line) { match(line, / name="[^"]*"/); return substr(line, RSTART + 7, RLENGTH - 8) }
function as_text(line) {
  sub(/.*<system-out>/, "", line); gsub(/<[^>]*>/, "", line); gsub(/&quot;/, "\"", line)
  gsub(/&lt;/, "<", line); gsub(/&gt;/, ">", line); gsub(/&amp;/, "\\&", line)
  return line
}'

# failures STAGE FILE: the name of each test that failed.
failures() { sed -n "s/.*<testcase name=\"\([^\"]*\)\".* status=\"fail\".*/  $1: \1/p" "$2"; }

# reasons STAGE FILE: the end of what each of the first five failed tests printed.
reasons() {
  awk -v stage="$1" "$xml"'
    /<testcase / { name = test_name($0); lines = 0; isFailed = / status="fail"/ }
    isFailed && /<system-out>/ { isOutput = 1 }
    isOutput { output[++lines] = as_text($0) }
    /<\/system-out>/ { isOutput = 0 }
    /<\/testcase>/ && isFailed && ++told <= 5 {
      print "  " stage ": " name
      for (i = lines > 40 ? lines - 39 : 1; i <= lines; ++i) print "    " output[i]
    }
  ' "$2"
}

# skips STAGE FILE: each skipped test with its reason: GoogleTest's message, or the last line of output.
skips() {
  awk -v stage="$1" "$xml"'
    /<testcase / { name = test_name($0); skipped = 0; stated = 0; reason = "" }
    /<skipped/ { skipped = 1 }
    { line = as_text($0); sub(/^[[:space:]]+/, "", line) }
    stated == 1 { reason = line; stated = 2 }
    stated == 0 && line ~ /[^[:space:]]/ { reason = line }
    /: Skipped$/ { stated = 1 }
    /<\/testcase>/ { if (skipped) print "  " stage ": " name ": " reason }
  ' "$2"
}

# tell FILE HEADING: prints a list unless it is empty.
tell() {
  [ -s "$1" ] || return 0
  say "$2"
  cat "$1"
}
