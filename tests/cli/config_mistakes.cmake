# Mistakes in text files (site, camera as TOML or YAML, scenario). All mistakes are reported with their positions, the
# exit code is 2, and no file is written. Where toml11 3 and 4 give different columns, the expression allows both.
set(target "[[target]]\\ngrating_mm = [0.0, 0.0]\\ngrating_size_mm = [40.0, 40.0]\\n")
set(centre "cx = 320.0\\ncy = 240.0\\n")

# config_case(KIND NAME TEXT POSITION_AND_MISTAKE...): TEXT is the content of bad.toml, written by printf. A single
# bracket must be written as \133, because it changes how CMake splits lists. Each further argument is a regular
# expression for a whole line of stderr.
function(config_case kind name text)
  set(mistakes "")
  foreach(mistake IN LISTS ARGN)
    list(APPEND mistakes "^bad\\.toml:${mistake}$")
  endforeach()
  set(site_words measure clip --site bad.toml -o out)
  set(camera_words measure clip --site good.toml --camera bad.toml -o out)
  set(scenario_words simulate bad.toml -o out)
  list(LENGTH ARGN count)
  set(these "this mistake")
  if(count GREATER 1)
    set(these "these ${count} mistakes")
  endif()
  set(title "^error: the (site file|camera file|scenario) has mistakes: bad\\.toml: correct ${these}:$")
  moiregauge_cli_test(config_mistakes_${kind}_${name} EXIT 2 ERROR_LINES 1 LEAVES_OUT out
    SETUP "mkdir clip && printf '%b' '[grating]\\npitch_mm = 10.0\\n${target}' > good.toml && printf '%b' '${text}' > bad.toml"
    COMMAND ${${kind}_words} STDERR ${title} ${mistakes})
endfunction()

set(not_finite "pitch_mm must be a finite number")
set(goes_on "there is text after the value, write numbers like 1\\.5, without a unit")
config_case(site bracket "\\133\\n" "1:[12]: .+")
config_case(site syntax "[grating]\\npitch_mm 10\\n${target}" "2:(1|10): there is no = after the key")
config_case(site unclosed_text "[grating]\\npattern = \"grid\\n${target}" "2:(1|16): .+")
config_case(site duplicate_key "[grating]\\npitch_mm = 10.0\\npitch_mm = 11.0\\n${target}" "3:(12|1): pitch_mm is given twice")
config_case(site duplicate_section "[grating]\\npitch_mm = 10.0\\n[grating]\\nangle_deg = 1.0\\n${target}" "3:1: .grating. is given twice")
config_case(site decimal_comma "[grating]\\npitch_mm = 1,5\\n${target}" "2:13: ${goes_on}")
config_case(site unit "[grating]\\npitch_mm = 10mm\\n${target}" "2:14: ${goes_on}")
config_case(site unit_in_quotes "[grating]\\npitch_mm = \"10mm\"\\n${target}" "2:12: ${not_finite}")
config_case(site nan "[grating]\\npitch_mm = nan\\n${target}" "2:12: ${not_finite}")
config_case(site too_large "[grating]\\npitch_mm = 1e999\\n${target}" "2:(12: pitch_mm|17: the value) must be a finite number")
config_case(site whole_number_too_large "[grating]\\npitch_mm = 99999999999999999999\\n${target}" "2:(12: pitch_mm|32: the value) must be a finite number")
config_case(site all_at_once "[grating]\\npitch_mm = -10.0\\nangel_deg = 1.0\\n[known_to]\\nheight_mm = inf\\n${target}z_mm = nan\\n"
  "2:12: pitch_mm must be greater than 0, not -10" "3:1: the key \"angel_deg\" is unknown, did you mean \"angle_deg\"."
  "5:13: height_mm must be a finite number" "9:8: z_mm must be a finite number")
set(middle "[grating]\\npitch_mm = 10.0\\n[[target]]\\nname = \"mid\"\\ngrating_mm = [0.0, 0.0]\\ngrating_size_mm = [40.0, 40.0]\\n")
config_case(site channels "${middle}[[channel]]\\nname = \"d\"\\nexpression = \"mid.dy - top.dy\"\\n[[channel]]\\nname = \"e\"\\nexpression = \"mid.dz\"\\n"
  "9:24: no target has the name .top., use one of mid .+" "12:19: a target has no quantity .dz., use dx, dy or rotation")

config_case(camera bracket "\\133\\n" "1:[12]: .+")
config_case(camera syntax "[camera]\\nfx 500\\nfy = 500.0\\n${centre}" "2:(1|4): there is no = after the key")
config_case(camera duplicate_key "[camera]\\nfx = 500.0\\nfx = 500.0\\nfy = 500.0\\n${centre}" "3:(6|1): fx is given twice")
config_case(camera decimal_comma "[camera]\\nfx = 500,5\\nfy = 500.0\\n${centre}" "2:9: ${goes_on}")
config_case(camera unit "[camera]\\nfx = 500px\\nfy = 500.0\\n${centre}" "2:9: ${goes_on}")
config_case(camera too_large "[camera]\\nfx = 1e999\\nfy = 500.0\\n${centre}" "2:(6: fx|11: the value) must be a finite number")
config_case(camera all_at_once "[camera]\\nfx = nan\\nfy = -500.0\\nk1 = nan\\nkk2 = 0.1\\nwidth = 640\\n${centre}"
  "2:6: fx must be a finite number" "3:6: fy must be greater than 0, not -500" "4:6: k1 must be a finite number"
  "5:1: the key \"kk2\" is unknown, did you mean \"k2\"." "6:9: give width and height together, or neither")
config_case(camera yaml_all_at_once
  "image_width: 640px\\nimage_height: 480\\ncamera_matrix:\\n  data: [1e999, 0, 320, 0, 500, 240, 0, 0, 1]\\nimage_height: 481\\ndistortion_coefficients: [0.1, .nan]\\n"
  "1:1: image_width must be a whole number of pixels" "3:1: camera_matrix contains \"1e999\", which is not a finite number"
  "5:1: image_height is given twice .first in line 2., .+" "6:1: distortion_coefficients contains \"\\.nan\", which is not a finite number")
config_case(camera yaml_negative "camera_matrix: [-500, 0, 320, 0, 500, 240, 0, 0, 1]\\n"
  "1:1: the focal lengths of camera_matrix must be greater than 0")

config_case(scenario bracket "\\133\\n" "1:[12]: .+")
config_case(scenario syntax "base \"small-1x\"\\n" "1:(1|6): there is no = after the key")
config_case(scenario duplicate_key "base = \"small-1x\"\\nframes = 3\\nframes = 4\\n" "3:(10|1): frames is given twice")
config_case(scenario decimal_comma "base = \"small-1x\"\\n[lens]\\nk1 = 1,5\\n" "3:7: ${goes_on}")
config_case(scenario unit "base = \"small-1x\"\\n[grating]\\npitch_mm = 10mm\\n" "3:14: ${goes_on}")
config_case(scenario too_large "base = \"small-1x\"\\n[lens]\\nk2 = 1e999\\n" "3:(6: lens\\.k2 must be a number|11: the value must be a finite number)")
config_case(scenario all_at_once
  "base = \"small-1x\"\\nframs = 3\\n[lens]\\nk1 = nan\\nk2 = inf\\n[grating]\\npitch_mm = -10.0\\n[sensor]\\nfps = 0\\n"
  "2:9: the key \"frams\" is unknown, did you mean \"frames\"." "4:6: lens\\.k1 must be a number" "5:6: lens\\.k2 must be a number"
  "7:12: .+pitch_mm must be greater than 0" "9:7: sensor\\.fps must be greater than 0")
