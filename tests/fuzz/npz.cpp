// NumPy's: structures in .npz and .npy, actions. What is accepted as a body is written and
// read again as it was.
#include "formats/io/npz.h"

#include "formats/io/learners.h"

#include "target.h"

using namespace evo;

FUZZ_TARGET(bytes) {
  (void)learner_file(bytes);
  try {
    const NumpyMatrix matrix = matrix_from_numpy(bytes, "actions", "input");
    expect(matrix.values.size() == matrix.rows * matrix.cols);
  } catch (const Error&) {
    // A body, perhaps.
  }
  const Body body = body_from_numpy(bytes, "input");
  expect(body_from_npz(body_to_npz(body), "written") == body);
}
