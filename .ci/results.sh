# shellcheck shell=sh
# Sourced by ./test: reads CTest's JUnit files, and tells what they say. A CTest that is a shard of a test program stands for the
# tests in it, which GoogleTest wrote to a file of the shard's name.

# Functions for awk: an attribute of a line of XML, and the text of one.
xml='function value(line, key) {
  return match(line, " " key "=\"[^\"]*\"") ? as_text(substr(line, RSTART + length(key) + 3, RLENGTH - length(key) - 4)) : ""
}
function as_text(line) {
  sub(/.*<system-out>/, "", line); gsub(/<[^>]*>/, "", line); gsub(/&quot;/, "\"", line); gsub(/&#x0A;/, "\n", line)
  gsub(/&lt;/, "<", line); gsub(/&gt;/, ">", line); gsub(/&amp;/, "\\&", line)
  return line
}'

# tests JUNIT SHARDS: prints a line "pass|fail|skip NAME REASON", separated by tabs, for each test. SHARDS is the folder of the
# shards' files. A shard that failed though none of its tests did, or that left no file, is one test.
tests() {
  awk -v shards="$2" "$xml"'
    function tell() { if (name != "") print status "\t" name "\t" reason; failures += status == "fail"; name = "" }
    function read_shard(file,  line) {
      failures = 0
      while ((getline line <file) > 0) {
        if (line ~ /<testcase /) { tell(); name = value(line, "classname") "." value(line, "name"); status = "pass"; reason = "" }
        if (line ~ /<failure /) status = "fail"
        if (line ~ /<skipped /) { status = "skip"; reason = value(line, "message"); sub(/^[^\n]*\n/, "", reason); sub(/\n+$/, "", reason); gsub(/\n/, " ", reason) }
      }
      close(file)
      tell()
      return failures
    }
    function end_test(  file) {
      if (test == "") return
      file = shards "/" test ".xml"
      if ((getline line <file) > 0) {
        close(file)
        if (read_shard(file) > 0 || test_status == "pass") { test = ""; return }
      }
      name = test; status = test_status; reason = status == "skip" ? last : ""
      tell()
      test = ""
    }
    /<testcase / { test = value($0, "name"); test_status = / status="fail"/ ? "fail" : "pass"; last = "" }
    /<skipped/ || / status="(disabled|notrun)"/ { test_status = "skip" }
    { line = as_text($0); sub(/^[[:space:]]+/, "", line); if (line ~ /[^[:space:]]/) last = line }
    /<\/testcase>/ { end_test() }
  ' "$1"
}

# reasons STAGE JUNIT: the end of what each of the first five failed tests printed.
reasons() {
  awk -v stage="$1" "$xml"'
    function tell(name,  i) {
      if (++told <= 5) {
        print "  " stage ": " name
        for (i = lines > 40 ? lines - 39 : 1; i <= lines; ++i) print "    " output[i]
      }
      lines = 0
    }
    /<testcase / { name = value($0, "name"); lines = 0; is_failed = / status="fail"/; told_before = told }
    is_failed && /<system-out>/ { is_output = 1 }
    is_output {
      line = as_text($0)
      if (line ~ /^\[ RUN      \] /) lines = 0
      output[++lines] = line
      if (line ~ /^\[  FAILED  \] .* ms\)$/) { split(line, word, " "); tell(word[4]) }
    }
    /<\/system-out>/ { is_output = 0 }
    /<\/testcase>/ && is_failed && told == told_before { tell(name) }
  ' "$2"
}

# tell FILE HEADING: prints a list unless it is empty.
tell() {
  [ -s "$1" ] || return 0
  say "$2"
  cat "$1"
}
