"""Input decks of CalculiX and Abaqus.

    text -> cards -> what a deck says -> with the matrices of its nodes: an FE model
    cards.py   reading.py (sets, surfaces, materials)   model.py (motion, solids)
"""
