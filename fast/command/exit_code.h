#pragma once

namespace touchstone::fast {

/// Of both programs; the README says what each means.
enum ExitCode { done = 0, answer_is_no = 1, bad_input = 2, not_converged = 3, interrupted = 130 };

}  // namespace touchstone::fast
