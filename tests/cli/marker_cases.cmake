# Faults of markers and light. Each is refused, excluded or measured, with a status or message.
set(draw "$MOIREGAUGE simulate small-1xyz --markers-only --quiet -o run")
set(measure measure run --site run/site.toml --fps 10 -o out)

moiregauge_cli_test(case_16_three_references_in_the_reference_frame EXIT 4 ERROR_LINES 1 STDERR "only 3 of 4 reference circles were found"
  SETUP "${draw} --frames 4 --set marker.NE.cover.frames='0 4'" COMMAND ${measure} WRITES out/overlay.png out/run.json
  LEAVES_OUT out/displacement.csv)
moiregauge_cli_test(case_17_three_references_in_some_frames EXIT 5 ERROR_LINES 0 STDOUT " 8 of 12$" "mid: 4 rows reference-lost .too few references"
  SETUP "${draw} --frames 12 --set marker.NE.cover.frames='4 8'" COMMAND ${measure} WRITES out/displacement.csv)
# A step of 0.069 mm is 0.2 px.
moiregauge_cli_test(case_18_a_reference_of_six_slips EXIT 0 ERROR_LINES 0 STDERR "^warning: reference 'NE' is not used, because it moves by up to 0.0[67]"
  SETUP "$MOIREGAUGE simulate small-six-slip --frames 10 --markers-only --quiet --set marker.NE.dy.knots='0.45 0 0.5 0.069' --set marker.NE.dy.scale=1 -o run"
  COMMAND ${measure} --json STDOUT "\"references_verified\": true" TIMEOUT 400)
moiregauge_cli_test(case_18_four_cannot_verify_each_other EXIT 0 ERROR_LINES 0 SETUP "${draw} --frames 6" COMMAND ${measure}
  STDOUT "^found: .*references not cross-checked: this needs 6 references")
# The target jumps by 1.6 pitches while it is covered.
moiregauge_cli_test(case_19_a_jump_out_of_sight EXIT 5 ERROR_LINES 0 STDOUT "^ +mid .* 16\\.00[0-9]* .* 6 of 7$" "mid: 1 row lost"
  SETUP "${draw} --frames 7 --set marker.mid.dy.knots='0.35 0 0.36 16' --set marker.mid.cover.frames='3 4'" COMMAND ${measure})
moiregauge_cli_test(case_20_look_alikes EXIT 0 ERROR_LINES 0 STDOUT " 4 of 4$"
  SETUP "$MOIREGAUGE simulate small-1xyz --quiet --frames 4 --set decoys=6 -o run" COMMAND ${measure})
moiregauge_cli_test(case_20_a_site_that_does_not_fit EXIT 4 ERROR_LINES 1 STDERR "^error: the run is refused because .*: run: " WRITES out/overlay.png
  SETUP "${draw} --frames 4 --set marker.NE.place.x_mm=-40" COMMAND ${measure})
moiregauge_cli_test(case_21_saturated EXIT 5 ERROR_LINES 0 STDOUT " 4 of 8$" "mid: 4 rows saturated"
  SETUP "${draw} --frames 8 --set light.flicker.knots='0.35 0 0.36 0.5'" COMMAND ${measure})
moiregauge_cli_test(case_21_blurred_by_a_pitch EXIT 5 ERROR_LINES 0 STDOUT "^ +mid .* 10\\.00[0-9]* .* 7 of 8$" "mid: 1 row (lost|blurred)"
  SETUP "${draw} --frames 8 --set sensor.exposure_s=0.05 --set marker.mid.dy.knots='0.375 0 0.425 10'" COMMAND ${measure})
moiregauge_cli_test(case_21_too_coarse EXIT 4 ERROR_LINES 1 STDERR "2\\.5 px" WRITES out/overlay.png
  SETUP "${draw} --frames 3 --set grating.pitch_mm=0.8" COMMAND ${measure})
moiregauge_cli_test(repeated_frames_are_counted EXIT 5 ERROR_LINES 0 STDERR "^warning: moving targets are not trusted in 2 of 8 frames, which repeat the frame before exactly .first: frame 4."
  SETUP "${draw} --frames 8 --set timing.repeated='4 6'" COMMAND ${measure} STDOUT " 6 of 8$" "mid: 2 rows untrusted" "^next: record without dropped frames")
