"""How the answers of declared studies are told: sentences, tables, figures and records, a file each."""
