/* Eight worlds built in code, side by side: two robots each, on one floor. The same wave runs
 * through both, shifted from world to world; which of them walks further?
 *   worlds
 */
#include <evo/evo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WORLDS = 8, STEPS = 300, WIDTH = 60 };

static void need(int result) {
  if (result == EVO_OK) return;
  fprintf(stderr, "worlds: %s\n", evo_error());
  exit(result);
}

/* The mean of an object's points in a world, voxels. */
static double centre_x(const evo_sim_arrays* at, const evo_sim_object* object, size_t world) {
  const double* points = at->positions + 2 * (at->points * world + object->first_point);
  double sum = 0;
  for (size_t i = 0; i < object->points; ++i) sum += points[2 * i];
  return sum / object->points / 0.1;
}

int main(void) {
  static const uint8_t walker[] = {EVO_SOFT,     EVO_HORIZONTAL, EVO_SOFT,      /* SHS */
                                   EVO_VERTICAL, EVO_EMPTY,      EVO_VERTICAL}; /* V.V */
  static const uint8_t block[] = {EVO_HORIZONTAL, EVO_VERTICAL, EVO_VERTICAL, EVO_HORIZONTAL};
  uint8_t ground[WIDTH];
  for (int i = 0; i < WIDTH; ++i) ground[i] = EVO_FIXED;

  evo_world* world;
  evo_sims* sims;
  evo_sim_arrays at;
  evo_sim_object robots[2];
  need(evo_world_new(&world));
  need(evo_world_add(world, "ground", ground, 1, WIDTH, NULL, 0, 0, 0));
  need(evo_world_add(world, "walker", walker, 2, 3, NULL, 0, 10, 1));
  need(evo_world_add(world, "block", block, 2, 2, NULL, 0, 30, 1));
  need(evo_sims_open(world, NULL, WORLDS, 1, &sims));
  evo_world_free(world);
  need(evo_sims_arrays(sims, &at, sizeof at));
  for (int k = 0; k < 2; ++k) need(evo_sims_object(sims, k, &robots[k], sizeof robots[k]));

  double* targets = malloc(WORLDS * at.actuators * sizeof *targets);
  if (targets == NULL) return 1;
  for (int t = 0; t < STEPS; ++t) {
    for (size_t i = 0; i < WORLDS * at.actuators; ++i)
      targets[i] = 1.1 + 0.5 * sin(0.3 * t + 0.5 * (i % at.actuators) + 0.2 * (i / at.actuators));
    need(evo_sims_step(sims, targets, WORLDS * at.actuators, NULL, 0));
  }
  printf("world  %6s  %6s\n", robots[0].name, robots[1].name);
  const double start[] = {robots[0].name[0] == 'w' ? 11.5 : 31,
                          robots[1].name[0] == 'w' ? 11.5 : 31};
  for (size_t w = 0; w < WORLDS; ++w)
    printf("%5zu  %6.2f  %6.2f\n", w, centre_x(&at, &robots[0], w) - start[0],
           centre_x(&at, &robots[1], w) - start[1]);
  free(targets);
  evo_sims_free(sims);
  return 0;
}
