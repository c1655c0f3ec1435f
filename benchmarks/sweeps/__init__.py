"""What sweep.py measures, a file a question. plan.py and views.py come before the sweeps, sweep_tables.py after."""
