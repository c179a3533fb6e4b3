/* What ParaView makes of a recording, where there is one: its readers' numbers beside those of the run. Prints a line
 * each; no ParaView: says so. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const char scene[] = "local scene = hooke.scene { duration = 0.5, fps = 60, integrator = 'leapfrog' }\n"
                            "local sheet = scene:grid { nx = 9, ny = 7, width = 1, height = 1, mass = 0.1 }\n"
                            "scene:pin { sheet:at(1, 1) }\n"
                            "scene:force('gravity', {})\n"
                            "scene:force('springs', { edges = sheet:structural(), k = 100 })\n"
                            "scene:source('emitter', { rate = 100, mass = 1e-3, lifetime = 0.2, speed = 1,\n"
                            "  position = { 0.5, 0.5, 1 } }) -- where nothing else is: ParaView merges points\n"
                            "scene:measure('particles', function(s) return s.n end)\n"
                            "scene:measure('lowest', function(s)\n"
                            "  local z = math.huge\n"
                            "  for _, id in ipairs(s:ids()) do z = math.min(z, s:position(id)[3]) end\n"
                            "  return z\n"
                            "end)\n"
                            "scene:output('trajectory', { forces = true })\n"
                            "return scene\n";

int main(void) {
  char folder[] = "/tmp/hooke-study-XXXXXX", command[2048];
  if (system("command -v pvpython >/dev/null 2>&1") != 0) {
    puts("there is no pvpython: recordings were not opened by ParaView");
    return 0;
  }
  if (!mkdtemp(folder) || chdir(folder) != 0) return 1;
  FILE *file = fopen("scene.lua", "w");
  if (!file || fputs(scene, file) < 0 || fclose(file) != 0) return 1;
  snprintf(command, sizeof command,
           "%s/hooke run scene.lua --out out --quiet && echo 'the run:' && head -n 1 out/measures.csv && tail -n 1 "
           "out/measures.csv && timeout 300 pvpython --no-mpi %s/tests/study/open_recording.py out; code=$?; rm -rf "
           "%s; exit "
           "$code",
           HK_BUILD, HK_ROOT, folder);
  return system(command) == 0 ? 0 : 1;
}
