# SPDX-License-Identifier: MIT
"""Runs that bad input must end, for the tests of what the program refuses."""

from run_fabseq import BAD_INPUT, FabseqTest, distinct


class BadInputTest(FabseqTest):
    rank_counts = distinct(3, 1)

    def assert_refused(self, config, *arguments, words, timeout=None, status=BAD_INPUT, **options):
        """The run must be refused with one line that holds all `words`, and leave the working directory as it
        was."""
        path = config if isinstance(config, str) else self.write_config(config)
        before = self.tree()
        for ranks in self.rank_counts:
            with self.subTest(ranks=ranks, words=words):
                result = self.run_program(ranks, "-config", path, *arguments, timeout=timeout, **options)
                self.assertEqual(result.status, status, str(result))
                self.assertEqual(result.stdout.strip(), "", str(result))
                messages = result.messages()
                self.assertEqual(len(messages), 1, str(result))
                self.assertTrue(messages[0].startswith("fabseq: "), str(result))
                for word in words:
                    self.assertIn(word, messages[0])
                self.assertEqual(self.tree(), before, "a refused run has touched files")
