// Holds nothing: the target needs a source file.
