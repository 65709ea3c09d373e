// Nothing: the library of this file has the precompiled headers of the tests.
