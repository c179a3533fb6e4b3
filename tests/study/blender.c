/* What Blender makes of a point cache, where there is one: the largest distance of its vertices from the run's
 * particles, which is that of 32-bit numbers. Prints a line; no Blender: says so. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const char scene[] = "local scene = hooke.scene { duration = 0.5, fps = 24, integrator = 'leapfrog' }\n"
                            "local sheet = scene:grid { nx = 9, ny = 7, width = 1, height = 1, mass = 0.1 }\n"
                            "scene:pin { sheet:at(1, 1) }\n"
                            "scene:force('gravity', {})\n"
                            "scene:force('springs', { edges = sheet:structural(), k = 100 })\n"
                            "scene:output('trajectory')\n"
                            "return scene\n";

int main(void) {
  char folder[] = "/tmp/hooke-study-XXXXXX", command[2048];
  if (system("command -v blender >/dev/null 2>&1") != 0) {
    puts("there is no Blender: point caches were not opened by it");
    return 0;
  }
  if (!mkdtemp(folder) || chdir(folder) != 0) return 1;
  FILE *file = fopen("scene.lua", "w");
  if (!file || fputs(scene, file) < 0 || fclose(file) != 0) return 1;
  snprintf(
      command, sizeof command,
      "hooke=%s/hooke; $hooke run scene.lua --out out --quiet && $hooke convert out --to pc2 && $hooke convert out "
      "--to csv && timeout 300 blender --background --python-exit-code 1 --python "
      "%s/tests/study/open_point_cache.py -- out >said 2>&1; code=$?; grep -a '^Blender .*:' said || cat said; "
      "rm -rf %s; exit $code",
      HK_BUILD, HK_ROOT, folder);
  return system(command) == 0 ? 0 : 1;
}
